#include "libhdr/probe/projection.h"

#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

/// Focal length in pixels of a pinhole camera with this horizontal field.
double focal_px(const Rectilinear& camera) {
  return 0.5 * camera.size.width / std::tan(0.5 * camera.fov_degrees * kDegree);
}

bool inside_frame(const Vec2& px, Size size) {
  return px.x() >= 0 && px.x() <= size.width && px.y() >= 0 && px.y() <= size.height;
}

void require_valid_disc(const Disc& disc, const char* name) {
  if (std::isfinite(disc.cx) && std::isfinite(disc.cy) && std::isfinite(disc.r) && disc.r > 0) return;
  throw Error(
      fmt::format("{}: the disc ({}, {}, {}) has no radius; give CX,CY,R in pixels", name, disc.cx, disc.cy, disc.r));
}

void require_valid_size(Size size, const char* name) {
  if (size.width > 0 && size.height > 0) return;
  throw Error(fmt::format("{}: a picture of {}x{} pixels is empty; give a width", name, size.width, size.height));
}

void require_valid_projection(const LatLong& map) {
  require_valid_size(map.size, LatLong::kName);
}
void require_valid_projection(const AngularMap& map) {
  require_valid_disc(map.disc, AngularMap::kName);
}
void require_valid_projection(const MirrorBall& ball) {
  require_valid_disc(ball.disc, MirrorBall::kName);
  if (!(ball.distance > 1)) {
    throw Error(
        fmt::format("mirror-ball: a camera at {} radii is inside the ball; give a distance above 1", ball.distance));
  }
}
void require_valid_projection(const Rectilinear& camera) {
  require_valid_size(camera.size, Rectilinear::kName);
  if (!(camera.fov_degrees > 0 && camera.fov_degrees < 180)) {
    throw Error(fmt::format("rectilinear: a field of {} degrees; give one between 0 and 180", camera.fov_degrees));
  }
}

}  // namespace

std::optional<Vec3> LatLong::dir_from_px(const Vec2& px) const {
  if (!inside_frame(px, size)) return std::nullopt;
  return dir_from_latlong(px.x() / size.width, px.y() / size.height);
}

std::optional<Vec2> LatLong::px_from_dir(const Vec3& dir) const {
  const Vec2 uv = latlong_from_dir(dir);
  return Vec2(uv.x() * size.width, uv.y() * size.height);
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

std::optional<Vec3> Rectilinear::dir_from_px(const Vec2& px) const {
  if (!inside_frame(px, size)) return std::nullopt;
  const double f = focal_px(*this);
  return Vec3(-(px.x() - 0.5 * size.width) / f, -(px.y() - 0.5 * size.height) / f, 1).normalized();
}

std::optional<Vec2> Rectilinear::px_from_dir(const Vec3& dir) const {
  if (dir.z() <= 0) return std::nullopt;
  const double f = focal_px(*this);
  const Vec2 px(0.5 * size.width - f * dir.x() / dir.z(), 0.5 * size.height - f * dir.y() / dir.z());
  if (!inside_frame(px, size)) return std::nullopt;
  return px;
}

std::optional<Vec3> dir_from_px(const Projection& projection, const Vec2& px) {
  return std::visit([&](const auto& p) { return p.dir_from_px(px); }, projection);
}

std::optional<Vec2> px_from_dir(const Projection& projection, const Vec3& dir) {
  return std::visit([&](const auto& p) { return p.px_from_dir(dir); }, projection);
}

void require_valid(const Projection& projection) {
  std::visit([](const auto& p) { require_valid_projection(p); }, projection);
}

}  // namespace hdr
