#include "libhdr/probe/projection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

bool inside_frame(const Vec2& px, Size size) {
  return px.x() >= 0 && px.x() <= size.width && px.y() >= 0 && px.y() <= size.height;
}

}  // namespace

std::optional<Vec3> LatLong::dir_from_px(const Vec2& px) const {
  if (!inside_frame(px, size)) return std::nullopt;
  const Vec3 dir = dir_from_latlong(px.x() / size.width, px.y() / size.height);
  if (convention == Convention::kOpenExr) return dir;
  return Vec3(openexr_from_convention(convention).transpose() * dir);
}

std::optional<Vec2> LatLong::px_from_dir(const Vec3& dir) const {
  const Vec2 uv =
      latlong_from_dir(convention == Convention::kOpenExr ? dir : Vec3(openexr_from_convention(convention) * dir));
  return Vec2(uv.x() * size.width, uv.y() * size.height);
}

std::optional<Vec3> Panorama::dir_from_px(const Vec2& px) const {
  if (!inside_frame(px, size)) return std::nullopt;
  const double azimuth = (azimuth_degrees + (px.x() / size.width - 0.5) * fov_degrees) * kDegree;  // to the right
  const double elevation = (elevation_degrees + (0.5 - px.y() / size.height) * vfov_degrees) * kDegree;
  const double level = std::cos(elevation);
  return Vec3(-level * std::sin(azimuth), std::sin(elevation), level * std::cos(azimuth));
}

std::optional<Vec2> Panorama::px_from_dir(const Vec3& dir) const {
  constexpr double kRounding = 1e-12;
  const double azimuth = std::atan2(-dir.x(), dir.z()) / kDegree;
  const double elevation = std::atan2(dir.y(), std::hypot(dir.x(), dir.z())) / kDegree;
  const double right = std::remainder(azimuth - azimuth_degrees, 360.0) / fov_degrees;
  const double down = (elevation_degrees - elevation) / vfov_degrees;
  if (!(std::abs(right) <= 0.5 + kRounding && std::abs(down) <= 0.5 + kRounding)) return std::nullopt;
  return Vec2(std::clamp(0.5 + right, 0.0, 1.0) * size.width, std::clamp(0.5 + down, 0.0, 1.0) * size.height);
}

Panorama cropped(const Panorama& panorama, int x, int y, Size size) {
  const Size all = panorama.size;
  if (x < 0 || y < 0 || size.width < 1 || size.height < 1 || x + size.width > all.width ||
      y + size.height > all.height) {
    throw Error(fmt::format("crop: {}x{} pixels at {},{} are not inside of the {}x{} picture; give X,Y,W,H in pixels",
                            size.width, size.height, x, y, all.width, all.height));
  }
  Panorama part = panorama;
  part.size = size;
  part.fov_degrees = panorama.fov_degrees * size.width / all.width;
  part.vfov_degrees = panorama.vfov_degrees * size.height / all.height;
  part.azimuth_degrees += ((x + 0.5 * size.width) / all.width - 0.5) * panorama.fov_degrees;
  part.elevation_degrees -= ((y + 0.5 * size.height) / all.height - 0.5) * panorama.vfov_degrees;
  return part;
}

std::optional<Vec3> AngularMap::dir_from_px(const Vec2& px) const {
  const double right = (px.x() - disc.cx) / disc.r;
  const double up = -(px.y() - disc.cy) / disc.r;
  const double radius = std::hypot(right, up);
  if (radius > 1) return std::nullopt;
  if (radius == 0) return Vec3(0, 0, 1);
  const double angle = kPi * radius;  // from +Z
  const double across = std::sin(angle) / radius;
  return Vec3(-across * right, across * up, std::cos(angle));
}

/// -Z is the whole rim; its rightmost point stands for it.
std::optional<Vec2> AngularMap::px_from_dir(const Vec3& dir) const {
  const double across = std::hypot(dir.x(), dir.y());
  const double radius = std::atan2(across, dir.z()) / kPi;
  if (across == 0) return Vec2(disc.cx + disc.r * radius, disc.cy);
  return Vec2(disc.cx - disc.r * radius * dir.x() / across, disc.cy - disc.r * radius * dir.y() / across);
}

std::optional<Vec3> dir_from_px(const Projection& projection, const Vec2& px) {
  if (!px.allFinite()) return std::nullopt;  // every comparison with NaN says no, and some mean "outside" by that
  return std::visit([&](const auto& p) { return p.dir_from_px(px); }, projection);
}

std::optional<Vec2> px_from_dir(const Projection& projection, const Vec3& dir) {
  return std::visit([&](const auto& p) { return p.px_from_dir(dir); }, projection);
}

bool is_plain_latlong(const Projection& projection) {
  const auto* map = std::get_if<LatLong>(&projection);
  return map && openexr_from_convention(map->convention).isIdentity(0);
}

std::optional<Disc> disc_of(const Projection& projection) {
  return std::visit(
      [](const auto& p) -> std::optional<Disc> {
        if constexpr (requires { p.disc; }) {
          return p.disc;
        } else {
          return std::nullopt;
        }
      },
      projection);
}

bool shows_whole_sphere(const Projection& projection) {
  if (const auto* lens = std::get_if<Fisheye>(&projection)) return lens->fov_degrees >= 360;
  if (const auto* part = std::get_if<Panorama>(&projection)) return part->closes() && part->vfov_degrees >= 180;
  return !std::holds_alternative<Rectilinear>(projection) && !std::holds_alternative<Hemisphere>(projection);
}

}  // namespace hdr
