// The pinhole camera, with the distortion of its lens.
#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

struct Distorted {
  Vec2 point;
  double xx, xy, yy;  ///< its derivatives; the mixed ones are equal
};

/// [Brown66], a point (x, y down) of the plane at distance 1.
Distorted distort(const BrownConrady& d, const Vec2& p) {
  const double x = p.x(), y = p.y(), r2 = p.squaredNorm();
  const double radial = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
  const double slope = d.k1 + r2 * (2 * d.k2 + r2 * 3 * d.k3);  // of radial, by r2
  return {{x * radial + 2 * d.p1 * x * y + d.p2 * (r2 + 2 * x * x),
           y * radial + d.p1 * (r2 + 2 * y * y) + 2 * d.p2 * x * y},
          radial + 2 * x * x * slope + 2 * d.p1 * y + 6 * d.p2 * x,
          2 * x * y * slope + 2 * d.p1 * x + 2 * d.p2 * y,
          radial + 2 * y * y * slope + 6 * d.p1 * y + 2 * d.p2 * x};
}

/// Whether the radius still rises with the angle out to r2: beyond where it turns, a polynomial folds the world over.
bool rises_to(const BrownConrady& d, double r2) {
  const auto slope = [&](double t) { return 1 + t * (3 * d.k1 + t * (5 * d.k2 + t * 7 * d.k3)); };
  if (!(slope(r2) > 0)) return false;
  // The slope is least at an end or where its own derivative 3 k1 + 10 k2 t + 21 k3 t^2 vanishes.
  const double a = 21 * d.k3, b = 10 * d.k2, c = 3 * d.k1;
  const double root = b * b - 4 * a * c;
  if (a == 0) {
    const double t = b == 0 ? -1 : -c / b;
    return !(t > 0 && t < r2) || slope(t) > 0;
  }
  if (root < 0) return true;
  for (const double sign : {-1.0, 1.0}) {
    const double t = (-b + sign * std::sqrt(root)) / (2 * a);
    if (t > 0 && t < r2 && !(slope(t) > 0)) return false;
  }
  return true;
}

/// Newton's steps from the distorted point itself; nullopt where the lens shows nothing.
std::optional<Vec2> undistort(const BrownConrady& d, const Vec2& seen) {
  constexpr int kMostSteps = 50;
  constexpr double kTolerance = 1e-14;
  Vec2 p = seen;
  for (int step = 0; step < kMostSteps; ++step) {
    const Distorted now = distort(d, p);
    const double det = now.xx * now.yy - now.xy * now.xy;
    if (!(std::abs(det) > 1e-12)) return std::nullopt;
    const Vec2 error = now.point - seen;
    const Vec2 move((now.yy * error.x() - now.xy * error.y()) / det, (now.xx * error.y() - now.xy * error.x()) / det);
    const double longest = 0.5 * (1 + p.norm());  // a step from a fold may lead anywhere
    p -= move * std::min(1.0, longest / std::max(move.norm(), 1e-300));
    if (move.norm() <= kTolerance * (1 + p.norm())) break;
  }
  if (!p.allFinite() || (distort(d, p).point - seen).norm() > 1e-9 * (1 + seen.norm())) return std::nullopt;
  if (!rises_to(d, p.squaredNorm())) return std::nullopt;
  return p;
}

bool inside_frame(const Vec2& px, Size size) {
  return px.x() >= 0 && px.x() <= size.width && px.y() >= 0 && px.y() <= size.height;
}

}  // namespace

double Rectilinear::focal_px() const {
  return 0.5 * size.width / std::tan(0.5 * fov_degrees * kDegree);
}

std::optional<Vec3> Rectilinear::dir_from_px(const Vec2& px) const {
  if (!inside_frame(px, size)) return std::nullopt;
  const double f = focal_px();
  Vec2 plane((px.x() - 0.5 * size.width) / f, (px.y() - 0.5 * size.height) / f);
  if (distortion != BrownConrady{}) {
    const auto straight = undistort(distortion, plane);
    if (!straight) return std::nullopt;
    plane = *straight;
  }
  return Vec3(-plane.x(), -plane.y(), 1).normalized();
}

std::optional<Vec2> Rectilinear::px_from_dir(const Vec3& dir) const {
  if (dir.z() <= 0) return std::nullopt;
  Vec2 plane(-dir.x() / dir.z(), -dir.y() / dir.z());
  if (distortion != BrownConrady{}) {
    if (!rises_to(distortion, plane.squaredNorm())) return std::nullopt;
    plane = distort(distortion, plane).point;
  }
  const double f = focal_px();
  const Vec2 px(0.5 * size.width + f * plane.x(), 0.5 * size.height + f * plane.y());
  if (!inside_frame(px, size)) return std::nullopt;
  return px;
}

}  // namespace hdr
