#include "libhdr/probe/internal/ball_sphere.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/ball_camera.h"
#include "libhdr/probe/internal/ball_glimpse.h"
#include "libhdr/probe/internal/luminance.h"
#include "libhdr/probe/unwrap.h"

namespace hdr::internal {
namespace {

double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

MirrorBall scaled(const MirrorBall& ball, double scale) {
  MirrorBall result = ball;
  result.disc = {scale * ball.disc.cx, scale * ball.disc.cy, scale * ball.disc.r};
  if (ball.principal) result.principal = Vec2(scale * *ball.principal);
  return result;
}

Vec3 direction_to_camera(const MirrorBall& ball) {
  if (!ball.principal || std::isinf(ball.distance)) return {0, 0, 1};
  return -camera_of(ball).to_ball;
}

/// A floor for logarithms: a small share of the median within the ball.
float log_floor(const Image<float>& luminance, const MirrorBall& ball) {
  constexpr float kShare = 0.02f;
  std::vector<float> values;
  const double r = ball.disc.r;
  const int step = std::max(1, static_cast<int>(r / 60));
  for (int y = std::max(0, static_cast<int>(ball.disc.cy - r)); y < luminance.height() && y < ball.disc.cy + r;
       y += step) {
    for (int x = std::max(0, static_cast<int>(ball.disc.cx - r)); x < luminance.width() && x < ball.disc.cx + r;
         x += step) {
      if (std::hypot(x + 0.5 - ball.disc.cx, y + 0.5 - ball.disc.cy) < r) values.push_back(luminance(x, y));
    }
  }
  if (values.empty()) return 1e-30f;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return std::max(1e-30f, kShare * values[values.size() / 2]);
}

/// The four taps of a lat-long around a direction, which wraps and ends at the poles.
float latlong_at(const Image<float>& map, const Vec3& dir) {
  const Vec2 uv = latlong_from_dir(dir);
  const double x = uv.x() * map.width() - 0.5, y = std::clamp(uv.y() * map.height() - 0.5, 0.0, map.height() - 1.0);
  const int left = static_cast<int>(std::floor(x)), top = std::min(static_cast<int>(y), map.height() - 2);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  const int x0 = (left + map.width()) % map.width(), x1 = (left + 1) % map.width();
  return (1 - fy) * ((1 - fx) * map(x0, top) + fx * map(x1, top)) +
         fy * ((1 - fx) * map(x0, top + 1) + fx * map(x1, top + 1));
}

/// What a wide blur, weighted, leaves of a map.
Image<float> without_wide_blur(const Image<float>& value, const Image<float>& weight) {
  constexpr int kWide = 6;  ///< pixels of the map in one of the blurred
  Image<float> both(value.size(), 2);
  for (int y = 0; y < value.height(); ++y) {
    for (int x = 0; x < value.width(); ++x) {
      both(x, y, 0) = value(x, y) * weight(x, y);
      both(x, y, 1) = weight(x, y);
    }
  }
  const Size small{std::max(8, value.width() / kWide), std::max(4, value.height() / kWide)};
  const Image<float> wide = resample(both, LatLong{value.size()}, LatLong{small}, small);
  Image<float> mean(small, 1), result(value.size(), 1);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) mean(x, y) = wide(x, y, 0) / std::max(wide(x, y, 1), 1e-6f);
  }
  for (int y = 0; y < value.height(); ++y) {
    for (int x = 0; x < value.width(); ++x) {
      const Vec3 dir = dir_from_latlong((x + 0.5) / value.width(), (y + 0.5) / value.height());
      result(x, y) = weight(x, y) > 0 ? value(x, y) - latlong_at(mean, dir) : 0;
    }
  }
  return result;
}

}  // namespace

double visibility(const BallView& view, const Vec3& dir) {
  const auto px = view.ball.px_from_dir(dir);
  if (!px) return 0;
  constexpr double kMargin = 1;
  if (!(px->x() > kMargin && px->y() > kMargin && px->x() < view.rgb.width() - kMargin &&
        px->y() < view.rgb.height() - kMargin))
    return 0;
  const double kept = view.mask.empty() ? 1 : bilinear(view.mask, *px);
  return kept * cos_incidence(view.ball, *px).value_or(0);
}

double nobody_there(const BallView& view, const Vec3& dir) {
  constexpr double kBeside = 16, kBesideEnd = 32;  ///< degrees of azimuth
  constexpr double kAbove = 18, kAboveEnd = 34;
  constexpr double kFeet = 80;
  const Vec3 camera = direction_to_camera(view.ball);
  const double up = std::asin(std::clamp(dir.y(), -1.0, 1.0)) / kDegree;
  const double camera_up = std::asin(std::clamp(camera.y(), -1.0, 1.0)) / kDegree;
  // The figure's width in degrees across, not in azimuth: it does not fan out towards the ground.
  const Vec3 side = Vec3(camera.z(), 0, -camera.x()).normalized();
  const Vec3 forward = Vec3(camera.x(), 0, camera.z()).normalized();
  if (dir.dot(forward) < 0) return 1;
  const double across = std::asin(std::clamp(std::abs(dir.dot(side)), 0.0, 1.0)) / kDegree;
  const double above = smooth_step(kAbove, kAboveEnd, up - camera_up);
  const double below = smooth_step(kFeet, 90, camera_up - up);
  return std::max({smooth_step(kBeside, kBesideEnd, across), above, below});
}

std::optional<double> LogView::at(const Vec3& dir, double inverse_distance, const Vec3& outline) const {
  const auto px = changed(ball, inverse_distance, outline).px_from_dir(dir);
  if (!px || !(px->x() > 0 && px->y() > 0 && px->x() < log_luminance.width() && px->y() < log_luminance.height()))
    return std::nullopt;
  return bilinear(log_luminance, *px);
}

LogView log_view(const BallView& view, double radius_px) {
  Image<float> luminance = luminance_of(view.rgb);
  double scale = 1;
  while (view.ball.disc.r * scale > 1.5 * radius_px && std::min(luminance.width(), luminance.height()) >= 16) {
    luminance = halved(luminance);
    scale *= 0.5;
  }
  LogView result{std::move(luminance), scaled(view.ball, scale)};
  const float floor = log_floor(result.log_luminance, result.ball);
  for (int y = 0; y < result.log_luminance.height(); ++y) {
    for (int x = 0; x < result.log_luminance.width(); ++x)
      result.log_luminance(x, y) = std::log(result.log_luminance(x, y) + floor);
  }
  return result;
}

SphereMap::SphereMap(const BallView& view, int width) : SphereMap(view, log_view(view, radius_for(width)), width) {}

SphereMap::SphereMap(const BallView& view, const LogView& picture, int width) : side_(width) {
  constexpr double kPhotographersSay = 0.05;
  const Size size{width, width / 2};
  MirrorBall ball = picture.ball;
  ball.distance = view.ball.distance;
  Image<float> value = resample(picture.log_luminance, ball, LatLong{size}, size), weight(size, 1);
  for_rows(size.height, 8, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const Vec3 dir = dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height);
        const double there = kPhotographersSay + (1 - kPhotographersSay) * nobody_there(view, dir);
        weight(x, y) = static_cast<float>(visibility(view, dir) * there);
      }
    }
  });
  value = without_wide_blur(value, weight);
  cells_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
  for_rows(side_ * side_, side_, [&](int first, int last) {
    for (int k = first; k < last; ++k) {
      const int x = k % side_, y = k / side_;
      double u = 2 * (x + 0.5) / side_ - 1, v = 2 * (y + 0.5) / side_ - 1;
      const double z = 1 - std::abs(u) - std::abs(v);
      if (z < 0) {  // the lower half is folded out
        const double folded = (1 - std::abs(v)) * std::copysign(1.0, u);
        v = (1 - std::abs(u)) * std::copysign(1.0, v);
        u = folded;
      }
      const Vec3 dir = Vec3(u, v, z).normalized();
      cells_[static_cast<std::size_t>(k)] = {latlong_at(value, dir), latlong_at(weight, dir)};
    }
  });
}

const SphereMap::Cell& SphereMap::at(const Vec3& dir) const {
  const double scale = 1 / (std::abs(dir.x()) + std::abs(dir.y()) + std::abs(dir.z()));
  double u = dir.x() * scale, v = dir.y() * scale;
  if (dir.z() < 0) {
    const double folded = (1 - std::abs(v)) * std::copysign(1.0, u);
    v = (1 - std::abs(u)) * std::copysign(1.0, v);
    u = folded;
  }
  const int x = std::clamp(static_cast<int>(0.5 * (u + 1) * side_), 0, side_ - 1);
  const int y = std::clamp(static_cast<int>(0.5 * (v + 1) * side_), 0, side_ - 1);
  return cells_[static_cast<std::size_t>(y * side_ + x)];
}

SampledSphere::SampledSphere(const SphereMap& map, const std::vector<Vec3>& directions)
    : directions_(directions.size()) {
  for (const Vec3& dir : directions) {
    if (const SphereMap::Cell& cell = map.at(dir); cell.weight > 0) samples_.push_back({dir, cell});
  }
}

double SampledSphere::correlation(const SphereMap& other, const Mat3& here_from_other) const {
  constexpr double kLeastOverlap = 0.04;  ///< mean weight of the directions; it is 0.3 when all of both views overlaps
  const Mat3 other_from_here = here_from_other.transpose();
  double w = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (const auto& [dir, here] : samples_) {
    const SphereMap::Cell& there = other.at(other_from_here * dir);
    const double weight = static_cast<double>(here.weight * there.weight);
    const double va = static_cast<double>(here.value), vb = static_cast<double>(there.value);
    w += weight;
    sa += weight * va;
    sb += weight * vb;
    saa += weight * va * va;
    sbb += weight * vb * vb;
    sab += weight * va * vb;
  }
  if (w < kLeastOverlap * static_cast<double>(directions_)) return -1;
  const double variance = (saa - sa * sa / w) * (sbb - sb * sb / w);
  return variance > 0 ? (sab - sa * sb / w) / std::sqrt(variance) : 0;
}

std::vector<Vec3> even_directions(int count) {
  const double golden = kPi * (3 - std::sqrt(5.0));
  std::vector<Vec3> directions;
  for (int k = 0; k < count; ++k) {
    const double y = 1 - (2 * k + 1.0) / count, s = std::sqrt(1 - y * y);
    directions.push_back({s * std::cos(golden * k), y, s * std::sin(golden * k)});
  }
  return directions;
}

}  // namespace hdr::internal
