#include "libhdr/probe/internal/coordinates.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

/// Chebyshev's points for cubics.
const std::array<double, 4> kNodes = {-std::cos(kPi / 8), -std::cos(3 * kPi / 8), std::cos(3 * kPi / 8),
                                      std::cos(kPi / 8)};

/// coefficient[i] of s^i = sum over k of kFit[i][k] value at node k: the inverse of Vandermonde's matrix.
Eigen::Matrix4d fit_matrix() {
  Eigen::Matrix4d powers;
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < 4; ++i) powers(k, i) = std::pow(kNodes[static_cast<std::size_t>(k)], i);
  }
  return powers.inverse();
}

double value(const Eigen::Matrix4d& coefficients, double s, double t) {
  const Eigen::Vector4d in_s(1, s, s * s, s * s * s), in_t(1, t, t * t, t * t * t);
  return in_t.dot(coefficients * in_s);
}

/// How far from +Z a lens sees, radians; nullopt: not known.
std::optional<double> reach_of(const Projection& projection) {
  if (const auto* lens = std::get_if<Fisheye>(&projection)) return 0.5 * lens->fov_degrees * kDegree;
  const auto* camera = std::get_if<Rectilinear>(&projection);
  if (!camera) return std::nullopt;
  // The frame's edge, at many points: distortion moves where it is farthest.
  constexpr int kPoints = 64;
  constexpr double kMargin = 0.02;
  double least_z = 1;
  for (int k = 0; k < kPoints; ++k) {
    const double along = (k + 0.5) / kPoints, w = camera->size.width, h = camera->size.height;
    for (const Vec2& px : {Vec2(along * w, 0), Vec2(along * w, h), Vec2(0, along * h), Vec2(w, along * h)}) {
      const auto dir = camera->dir_from_px(px);
      if (!dir) return std::nullopt;
      least_z = std::min(least_z, dir->z());
    }
  }
  return std::acos(std::clamp(least_z, -1.0, 1.0)) + kMargin;
}

}  // namespace

Coordinates::Coordinates(const Neighbourhood& source, const Projection& to, const Mat3& source_from_probe, Size size)
    : source_(source), to_(to), source_from_probe_(source_from_probe), size_(size) {
  if (const auto reach = reach_of(source.projection())) lens_reach_ = *reach;
}

bool Coordinates::shows_nothing(const Tile& tile) const {
  const auto* map = std::get_if<LatLong>(&to_);
  if (!map || lens_reach_ > kPi) return false;
  // Two directions of a lat-long are no further apart than its steps in azimuth and in height say.
  const double right = kPi * tile.width / map->size.width, down = 0.5 * kPi * tile.height / map->size.height;
  const Vec2 middle(tile.first_x + 0.5 * tile.width, tile.first_y + 0.5 * tile.height);
  const Vec3 dir = source_from_probe_ * *map->dir_from_px(middle);
  return std::acos(std::clamp(dir.z(), -1.0, 1.0)) > lens_reach_ + right + down;
}

std::optional<Vec2> Coordinates::exact(const Vec2& output_px) const {
  const auto dir = dir_from_px(to_, output_px);
  if (!dir) return std::nullopt;
  const auto px = px_from_dir(source_.projection(), source_from_probe_ * *dir);
  if (!px) return std::nullopt;
  // A point outside of the frame has no place in the source either: a ball may be cut off by its picture.
  const View<const float> pixels = source_.pixels();
  if (!(px->x() >= 0 && px->y() >= 0 && px->x() <= pixels.width() && px->y() <= pixels.height())) return std::nullopt;
  return px;
}

Vec2 Coordinates::short_way(Vec2 step) const {
  const double width = source_.pixels().width();
  if (source_.is_latlong() && step.x() > 0.5 * width) step.x() -= width;
  if (source_.is_latlong() && step.x() < -0.5 * width) step.x() += width;
  return step;
}

std::optional<TilePolynomial> Coordinates::polynomial(const Tile& tile) const {
  static const Eigen::Matrix4d kFit = fit_matrix();
  const Vec2 middle(tile.first_x + 0.5 * tile.width, tile.first_y + 0.5 * tile.height);
  const auto at = [&](double s, double t) { return exact(middle + Vec2(0.5 * s * tile.width, 0.5 * t * tile.height)); };
  const auto centre = at(0, 0);
  if (!centre) return std::nullopt;
  const int region = source_.region_of(*centre);
  const Vec2 base(std::floor(centre->x()), std::floor(centre->y()));
  Eigen::Matrix4d x, y;  // (t, s)
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const auto px = at(kNodes[static_cast<std::size_t>(i)], kNodes[static_cast<std::size_t>(j)]);
      if (!px || source_.region_of(*px) != region) return std::nullopt;
      const Vec2 step = short_way(*px - base);
      x(j, i) = step.x();
      y(j, i) = step.y();
    }
  }
  const Eigen::Matrix4d fitted_x = kFit * x * kFit.transpose(), fitted_y = kFit * y * kFit.transpose();
  const double u = 1 - 1.0 / tile.width, v = 1 - 1.0 / tile.height;  // the outermost pixels' centres
  for (const auto& [s, t] : {std::pair{0.0, 0.0}, {-u, -v}, {u, -v}, {-u, v}, {u, v}}) {
    const auto px = s == 0 ? centre : at(s, t);
    if (!px || source_.region_of(*px) != region) return std::nullopt;
    const Vec2 error = short_way(*px - base) - Vec2(value(fitted_x, s, t), value(fitted_y, s, t));
    if (!(error.squaredNorm() < kTolerance * kTolerance)) return std::nullopt;
  }
  TilePolynomial result{region, static_cast<int>(base.x()), static_cast<int>(base.y()), {}, {}};
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      result.x[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] = static_cast<float>(fitted_x(j, i));
      result.y[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] = static_cast<float>(fitted_y(j, i));
    }
  }
  return result;
}

/// By differences over a step so short that few seams fall into it; where one does, the other side's.
Vec2 Coordinates::slope(const Vec2& output_px, const Vec2& here, const Vec2& step) const {
  const auto before = exact(output_px - step), after = exact(output_px + step);
  const double length = step.norm();
  const Vec2 back = before ? Vec2(short_way(here - *before) / length) : Vec2::Zero();
  const Vec2 forth = after ? Vec2(short_way(*after - here) / length) : Vec2::Zero();
  if (!before || !after) return before ? back : forth;
  const double a = back.norm(), b = forth.norm();
  if ((back - forth).norm() <= 0.5 * std::max(a, b)) return 0.5 * (back + forth);
  return a < b ? back : forth;
}

std::optional<Place> Coordinates::place(int x, int y) const {
  constexpr double kStep = 1.0 / 64;
  constexpr int kParts = 4;  // a side, of a pixel that is shown in part
  Vec2 at(x + 0.5, y + 0.5);
  auto px = exact(at);
  if (!px) {
    double nearest = 2;
    for (int part = 0; part < kParts * kParts; ++part) {
      const Vec2 offset((part % kParts + 0.5) / kParts - 0.5, (part / kParts + 0.5) / kParts - 0.5);
      const Vec2 there(x + 0.5 + offset.x(), y + 0.5 + offset.y());
      if (offset.squaredNorm() >= nearest) continue;
      const auto shown = exact(there);
      if (!shown) continue;
      px = shown;
      at = there;
      nearest = offset.squaredNorm();
    }
    if (!px) return std::nullopt;
  }
  const Vec2 u = slope(at, *px, {kStep, 0}), v = slope(at, *px, {0, kStep});
  return Place{*px, u.x(), v.x(), u.y(), v.y()};
}

}  // namespace hdr::internal
