// The mirror ball, the exact ray. The ball has radius 1 and its centre at the origin, the camera is a pinhole at
// (0, 0, D) that looks along -Z. Disc coordinates (x, y), outline at 1, y up: the pixel's ray is (x t, y t, -1) with
// t = tan A = 1 / sqrt(D^2 - 1), A = asin(1/D) being half the angle that the ball fills. D = infinity: rays along -Z.
#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

/// Disc radius at which a far camera sees the direction at angle theta from +Z: sin(theta / 2), without cancellation at
/// either end.
double far_radius(double sin_theta, double cos_theta) {
  return cos_theta > 0 ? sin_theta / std::sqrt(2 * (1 + cos_theta)) : std::sqrt(0.5 * (1 - cos_theta));
}

/// Angle psi of the normal at which the ball shows a camera at D the direction at angle theta:
///   theta = 2 psi + atan2(sin psi, D - cos psi),
/// which rises on [0, acos(1/D)]. Newton's steps, kept inside a bracket that bisection shrinks.
double normal_angle(double theta, double d) {
  constexpr int kMostSteps = 60;
  constexpr double kTolerance = 1e-13;
  const double psi_rim = std::acos(1 / d);
  double low = 0, high = psi_rim;
  double psi = std::min(high, theta * psi_rim / (kPi - std::asin(1 / d)));
  for (int step = 0; step < kMostSteps; ++step) {
    const double s = std::sin(psi), c = std::cos(psi);
    const double error = 2 * psi + std::atan2(s, d - c) - theta;
    (error > 0 ? high : low) = psi;
    const double slope = 2 + (d * c - 1) / (d * d + 1 - 2 * d * c);
    double next = psi - error / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const bool done = std::abs(next - psi) < kTolerance;
    psi = next;
    if (done) break;
  }
  return psi;
}

/// Disc radius at which a camera at D sees the direction at angle theta; nullopt in the cone that the ball hides.
std::optional<double> near_radius(double theta, double d) {
  constexpr double kRounding = 1e-14;
  if (theta > kPi - std::asin(1 / d) + kRounding) return std::nullopt;
  const double psi = normal_angle(theta, d);
  return std::min(1.0, std::sin(psi) / (d - std::cos(psi)) * std::sqrt(d * d - 1));
}

void require_outside(double d) {
  if (!(d > 1)) throw Error("mirror-ball: the camera is inside the ball; give a distance above 1 radius");
}

}  // namespace

std::optional<Vec3> MirrorBall::dir_from_px(const Vec2& px) const {
  require_outside(distance);
  const double x = (px.x() - disc.cx) / disc.r;
  const double y = -(px.y() - disc.cy) / disc.r;
  const double radius2 = x * x + y * y;
  if (radius2 > 1) return std::nullopt;
  const double z = std::sqrt(1 - radius2);
  if (std::isinf(distance)) return Vec3(2 * z * x, 2 * z * y, 2 * z * z - 1);  // 2 (n.z) n - z
  // The ray (0, 0, D) + s v meets the sphere where v.v s^2 - 2 D s + D^2 - 1 = 0; its discriminant is 1 - x^2 - y^2.
  const double t = 1 / std::sqrt(distance * distance - 1);
  const Vec3 v(x * t, y * t, -1);
  const double vv = v.squaredNorm();
  const Vec3 n = Vec3(0, 0, distance) + (distance - z) / vv * v;
  // Reflect: v - 2 (n.v) n.
  return (v - 2 * n.dot(v) * n).normalized();
}

/// For a far camera -Z is the whole rim; its rightmost point stands for it.
std::optional<Vec2> MirrorBall::px_from_dir(const Vec3& dir) const {
  require_outside(distance);
  const double sin_theta = std::sqrt(dir.x() * dir.x() + dir.y() * dir.y());
  const auto radius = std::isinf(distance) ? std::optional(far_radius(sin_theta, dir.z()))
                                           : near_radius(std::atan2(sin_theta, dir.z()), distance);
  if (!radius) return std::nullopt;
  if (sin_theta == 0) return Vec2(disc.cx + disc.r * *radius, disc.cy);
  return Vec2(disc.cx + disc.r * *radius * dir.x() / sin_theta, disc.cy - disc.r * *radius * dir.y() / sin_theta);
}

}  // namespace hdr
