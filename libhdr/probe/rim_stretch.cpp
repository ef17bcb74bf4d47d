#include "libhdr/probe/internal/rim_stretch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "libhdr/core/sphere.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/luminance.h"

namespace hdr::internal {
namespace {

constexpr int kAzimuths = 180;
constexpr double kStep = 1;         ///< pixels to both sides over which a slope is taken
constexpr double kFromRim = 2.5;    ///< pixels that stay clear of the rim and its blur
constexpr double kMostSlope = 1.2;  ///< ln a pixel that one slope may count: a lamp's edge is not all there is

/// Slopes of log luminance around a ring.
struct Slopes {
  std::vector<double> along, across;  ///< along the radius; along the ring
};

Slopes slopes_at(View<const float> picture, const Disc& circle, double radius) {
  const auto at = [&](double r, double azimuth) {
    return Vec2(circle.cx + r * std::cos(azimuth), circle.cy + r * std::sin(azimuth));
  };
  const auto inside = [&](const Vec2& p) {
    return p.x() > 1 && p.y() > 1 && p.x() < picture.width() - 1 && p.y() < picture.height() - 1;
  };
  const auto value = [&](const Vec2& p) { return std::log(std::max(bilinear(picture, p), 1e-30)); };
  Slopes slopes;
  for (int k = 0; k < kAzimuths; ++k) {
    const double azimuth = 2 * kPi * k / kAzimuths, turn = kStep / radius;
    if (!inside(at(radius + kStep, azimuth))) continue;
    const auto slope = [&](const Vec2& from, const Vec2& to) {
      return std::clamp((value(to) - value(from)) / (2 * kStep), -kMostSlope, kMostSlope);
    };
    slopes.along.push_back(slope(at(radius - kStep, azimuth), at(radius + kStep, azimuth)));
    slopes.across.push_back(slope(at(radius, azimuth - turn), at(radius, azimuth + turn)));
  }
  return slopes;
}

/// A mean size in which few large slopes, such as a horizon's, count little.
double size_of(const std::vector<double>& slopes, double centre) {
  double sum = 0;
  for (const double v : slopes) sum += std::sqrt(std::abs(v - centre));
  return std::pow(sum / static_cast<double>(slopes.size()), 2);
}

}  // namespace

double rim_stretch(View<const float> luminance, const Disc& circle, double noise) {
  // The mean size of noise's slopes: bilinear readings have two thirds of a pixel's noise.
  const double floor = 0.8 * noise * 0.67 * std::sqrt(2.0) / (2 * kStep);
  double found = 0, expected = 0;
  for (double r = 0.6; r < 0.975; r += 0.025) {
    if ((1 - r) * circle.r < kFromRim) break;
    const Slopes slopes = slopes_at(luminance, circle, r * circle.r);
    if (static_cast<int>(slopes.along.size()) < kAzimuths / 2) continue;
    const double ring =
        std::accumulate(slopes.along.begin(), slopes.along.end(), 0.0) / static_cast<double>(slopes.along.size());
    const double along = size_of(slopes.along, ring), across = size_of(slopes.across, 0);
    // Where a ring's edge is all there is, what is left of it without its mean is the pixels' raster.
    const double own = std::clamp(1.5 - std::abs(ring) / (4 * std::max(along, 1e-30)), 0.0, 1.0);
    // Noise lies no way: it is taken out of both.
    const double a = std::sqrt(std::max(0.0, along * along - floor * floor)) + floor;
    const double b = std::sqrt(std::max(0.0, across * across - floor * floor)) + floor;
    const double stretch = -std::log(1 - r * r);
    found += own * stretch * std::log(a / b);
    expected += stretch * stretch;
  }
  return expected > 0 ? found / expected : 0;
}

}  // namespace hdr::internal
