// The sphere on a square: (s, t) in [-1, 1]^2 with s along +X and t along +Z, the upper half inside |s| + |t| <= 1 and
// the lower folded outwards over that diamond's edges.
#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

/// Folds a point of the lower half out of, or back into, the diamond.
Vec2 folded(const Vec2& p) {
  return {std::copysign(1 - std::abs(p.y()), p.x()), std::copysign(1 - std::abs(p.x()), p.y())};
}

/// [Meyer10]: the octahedron |x| + |y| + |z| = 1 seen from above.
Vec3 plain_dir(const Vec2& p) {
  const double y = 1 - std::abs(p.x()) - std::abs(p.y());
  const Vec2 q = y < 0 ? folded(p) : p;
  return Vec3(q.x(), y, q.y()).normalized();
}

Vec2 plain_point(const Vec3& dir) {
  const double sum = dir.cwiseAbs().sum();
  const Vec2 p(dir.x() / sum, dir.z() / sum);
  return dir.y() < 0 ? folded(p) : p;
}

/// [Clarberg08]: the distance r from the middle, measured along the axes, holds the area 2 pi r^2 of the half sphere.
Vec3 equal_area_dir(const Vec2& p) {
  const double s = std::abs(p.x()), t = std::abs(p.y());
  const double signed_distance = 1 - (s + t);
  const double r = 1 - std::abs(signed_distance);
  const double phi = (r == 0 ? 1 : (t - s) / r + 1) * 0.25 * kPi;
  const double across = r * std::sqrt(std::max(0.0, 2 - r * r));
  return {across * std::copysign(std::cos(phi), p.x()), std::copysign(1 - r * r, signed_distance),
          across * std::copysign(std::sin(phi), p.y())};
}

Vec2 equal_area_point(const Vec3& dir) {
  const double x = std::abs(dir.x()), z = std::abs(dir.z());
  // r = sqrt(1 - |y|), written so that it keeps its precision where |y| is close to 1.
  const double r = std::hypot(x, z) / std::sqrt(1 + std::abs(dir.y()));
  const double phi = x == 0 && z == 0 ? 0 : std::atan2(z, x) * 2 / kPi;
  double t = phi * r, s = r - t;
  if (dir.y() < 0) {
    std::swap(s, t);
    s = 1 - s;
    t = 1 - t;
  }
  return {std::copysign(s, dir.x()), std::copysign(t, dir.z())};
}

}  // namespace

std::optional<Vec3> Octahedral::dir_from_px(const Vec2& px) const {
  if (!(px.x() >= 0 && px.x() <= size.width && px.y() >= 0 && px.y() <= size.height)) return std::nullopt;
  const Vec2 p(2 * px.x() / size.width - 1, 2 * px.y() / size.height - 1);
  return equal_area ? equal_area_dir(p) : plain_dir(p);
}

std::optional<Vec2> Octahedral::px_from_dir(const Vec3& dir) const {
  const Vec2 p = equal_area ? equal_area_point(dir) : plain_point(dir);
  return Vec2(0.5 * (p.x() + 1) * size.width, 0.5 * (p.y() + 1) * size.height);
}

}  // namespace hdr
