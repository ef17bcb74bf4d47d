#include "libhdr/light/diffuse_ball.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/ball_normal.h"

namespace hdr {
namespace {

constexpr int kGrid = 24;             // cells across
constexpr double kLeastCosine = 0.2;  // between normal and view, and two pixels from the rim

struct Cell {
  Vec3 normal = Vec3::Zero();
  Rgb light = Rgb::Zero();
  double weight = 0;
};

// Lambert's azimuthal map keeps areas: the half sphere about the camera is a disc of radius 1.
int cell_of(const Vec3& normal, const Vec3& to_camera, const Vec3& across, const Vec3& up) {
  const double scale = 1 / std::sqrt(1 + normal.dot(to_camera));
  const auto place = [&](const Vec3& axis) {
    return std::clamp(static_cast<int>(0.5 * kGrid * (1 + scale * normal.dot(axis))), 0, kGrid - 1);
  };
  return place(up) * kGrid + place(across);
}

}  // namespace

BallReadings read_diffuse_ball(View<const float> rgb, const MirrorBall& ball, const Rgb& albedo) {
  HDR_ASSERT(rgb.channels() == 3 && (albedo > 0).all());
  const Vec3 to_camera = normal_from_px(ball, {ball.disc.cx, ball.disc.cy}).value_or(Vec3::UnitZ());
  const Vec3 across = Vec3::UnitY().cross(to_camera).normalized(), up = to_camera.cross(across);
  const double least = std::max(kLeastCosine, std::sqrt(std::min(1.0, 4 / ball.disc.r)));  // r - 2 px: sqrt(2 * 2 / r)
  std::vector<Cell> cells(static_cast<std::size_t>(kGrid * kGrid));
  BallReadings result;
  const double reach = 2 * ball.disc.r;  // of an ellipse's longer axis, and more
  const auto first = [&](double centre) { return std::max(0, static_cast<int>(centre - reach)); };
  for (int y = first(ball.disc.cy); y < std::min<double>(rgb.height(), ball.disc.cy + reach); ++y) {
    for (int x = first(ball.disc.cx); x < std::min<double>(rgb.width(), ball.disc.cx + reach); ++x) {
      const Vec2 px(x + 0.5, y + 0.5);
      const auto cosine = cos_incidence(ball, px);
      if (!cosine || *cosine < least) continue;
      const float* p = rgb.pixel(x, y);
      const Rgb radiance(p[0], p[1], p[2]);
      if (!radiance.isFinite().all() || !(radiance > 0).all()) {
        ++result.unusable;
        continue;
      }
      const Vec3 normal = *normal_from_px(ball, px);
      Cell& cell = cells[static_cast<std::size_t>(cell_of(normal, to_camera, across, up))];
      cell.normal += normal / *cosine;  // a pixel's share of the sphere of normals
      cell.light += radiance / *cosine;
      cell.weight += 1 / *cosine;
      ++result.pixels;
    }
  }
  for (const Cell& cell : cells) {
    if (!(cell.weight > 0)) continue;
    // While a light reaches all of a cell its irradiance is linear in the normal: their mean's, whose length is
    // below 1.
    result.readings.push_back({cell.normal.normalized(), kPi * cell.light / albedo / cell.normal.norm()});
  }
  return result;
}

}  // namespace hdr
