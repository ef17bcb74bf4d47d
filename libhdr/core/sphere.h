#pragma once
// The one place where directions, axes and pixel coordinates are defined.
//
// World: right-handed, +Y up.
// Lat-long: the centre looks along +Z, +X is to the LEFT of the centre (seen from inside, as OpenEXR's envmaps, USD's
//   DomeLight and Mitsuba 3 have it). Continuous coordinates u, v in [0,1], u to the right and v down; pixel x covers
//   [x/W, (x+1)/W], so its centre is u = (x + 0.5) / W.
// Angular map, fisheye, rectilinear: the camera looks along +Z; image right = -X, image up = +Y.
// Mirror ball: the camera stands on +Z and looks along -Z; image right = +X, image up = +Y.
// Pixels: continuous coordinates, pixel (0,0) covers [0,1]x[0,1] and its centre is (0.5, 0.5); y points down. Only
//   ref_from_photo (align/) has pixel centres at integers, as OpenCV's warps do.
#include <cmath>
#include <numbers>

#include "libhdr/core/vec.h"

namespace hdr {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180.0;

/// Direction (unit) of the lat-long point u, v in [0,1].
inline Vec3 dir_from_latlong(double u, double v) {
  const double azimuth = 2 * kPi * (0.5 - u);  // from +Z towards +X: left of the centre is positive
  const double polar = kPi * v;                // from +Y
  const double s = std::sin(polar);
  return {s * std::sin(azimuth), std::cos(polar), s * std::cos(azimuth)};
}

/// Lat-long point (u in [0,1), v in [0,1]) of a unit direction. The poles map to u = 0.5.
inline Vec2 latlong_from_dir(const Vec3& d) {
  const double horizontal = std::hypot(d.x(), d.z());
  double u = horizontal > 0 ? 0.5 - std::atan2(d.x(), d.z()) / (2 * kPi) : 0.5;
  if (u < 0) u += 1;
  if (u >= 1) u -= 1;
  return {u, std::atan2(horizontal, d.y()) / kPi};  // atan2 keeps its precision at the poles, where acos loses it
}

/// Exact solid angle (sr) of each pixel of row y of a width x height lat-long.
inline double latlong_pixel_solid_angle(int y, int width, int height) {
  const double top = kPi * y / height;
  const double bottom = kPi * (y + 1) / height;
  // cos a - cos b as a product: no cancellation at the poles
  return 2 * kPi / width * 2 * std::sin(0.5 * (top + bottom)) * std::sin(0.5 * (bottom - top));
}

/// d_out = R d_in with R = Rz Ry Rx, angles in degrees (--rotate X,Y,Z).
inline Mat3 rotation_from_degrees(const Vec3& xyz) {
  return (Eigen::AngleAxisd(xyz.z() * kDegree, Vec3::UnitZ()) * Eigen::AngleAxisd(xyz.y() * kDegree, Vec3::UnitY()) *
          Eigen::AngleAxisd(xyz.x() * kDegree, Vec3::UnitX()))
      .toRotationMatrix();
}

/// Two unit tangents t, b so that (t, b, n) is right-handed and orthonormal, without a branch that jumps.
/// [Duff17] Building an Orthonormal Basis, Revisited.
inline void tangents_from_normal(const Vec3f& n, Vec3f& t, Vec3f& b) {
  const float sign = std::copysign(1.0f, n.z());
  const float a = -1.0f / (sign + n.z());
  const float c = n.x() * n.y() * a;
  t = {1.0f + sign * n.x() * n.x() * a, sign * c, -sign * n.x()};
  b = {c, sign + n.y() * n.y() * a, -n.y()};
}

}  // namespace hdr
