// The spline that interpolates what is smooth, by itself: its error, its reach, and the check before it.
#include "libhdr/probe/internal/spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "libhdr/core/random.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/pixel_filter.h"

namespace hdr::internal {
namespace {

constexpr int kSide = 40;

Image<float> picture_of(const std::function<double(int x, int y)>& light) {
  Image<float> picture(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      for (int c = 0; c < 3; ++c) picture(x, y, c) = static_cast<float>(light(x, y) * (1 + 0.5 * c));
    }
  }
  return picture;
}

/// Values of the first channel at positions in pixel numbers.
std::vector<double> interpolated(const Image<float>& picture, const std::vector<Vec2>& places) {
  SplineTile spline;
  spline.fill(picture.row(0), picture.stride(), {3, 3, kSide - 3, kSide - 3});
  auto pixels = std::make_unique<TilePixels>();
  const std::vector<KernelKind> kinds(places.size(), KernelKind::kSpline);
  for (std::size_t k = 0; k < places.size(); ++k) {
    pixels->x[k] = static_cast<float>(places[k].x());
    pixels->y[k] = static_cast<float>(places[k].y());
  }
  std::vector<float> rgb(3 * places.size());
  filter_row({picture.row(0), picture.width(), picture.stride(), pixels.get(), kinds.data(), 0,
              static_cast<int>(places.size()), -std::numeric_limits<float>::infinity(), &spline},
             rgb.data());
  std::vector<double> values(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_NEAR(rgb[3 * k + 2], 2 * rgb[3 * k], 1e-5 * std::abs(rgb[3 * k]) + 1e-6) << "channels got mixed";
    values[k] = static_cast<double>(rgb[3 * k]);
  }
  return values;
}

std::vector<Vec2> random_places(std::uint64_t seed) {
  Random random(seed, 5);
  std::vector<Vec2> places(500);
  for (Vec2& p : places) p = {5 + (kSide - 11) * random.uniform(), 5 + (kSide - 11) * random.uniform()};
  return places;
}

/// rms over positions and phases, of a wave of amplitude 1.
double error_at(double frequency, bool down) {
  double squares = 0;
  int count = 0;
  for (int k = 0; k < 16; ++k) {
    const auto wave = [&](double x, double y) {
      return std::sin(2 * std::numbers::pi * (frequency * (down ? y : x) + k / 16.0));
    };
    const std::vector<Vec2> places = random_places(static_cast<std::uint64_t>(k));
    const std::vector<double> values = interpolated(picture_of(wave), places);
    for (std::size_t i = 0; i < places.size(); ++i, ++count) {
      squares += std::pow(values[i] - wave(places[i].x(), places[i].y()), 2);
    }
  }
  return std::sqrt(2 * squares / count);  // the header's figures are of complex waves
}

TEST(Spline, ErrorsAreThoseOfItsHeader) {
  for (const bool down : {false, true}) {
    EXPECT_LT(error_at(1.0 / 16, down), 0.7e-4);
    EXPECT_NEAR(error_at(1.0 / 8, down), 4.6e-4, 0.9e-4);
    EXPECT_NEAR(error_at(1.0 / 5, down), 4.0e-3, 0.4e-3);
    EXPECT_NEAR(error_at(1.0 / 4, down), 1.3e-2, 0.2e-2);
  }
}

TEST(Spline, AConstantStaysWhatItIs) {
  for (const double value : interpolated(picture_of([](int, int) { return 3.0; }), random_places(3))) {
    EXPECT_NEAR(value, 3, 1e-5);
  }
}

TEST(Spline, ASunReachesNoFartherThanItsReach) {
  constexpr int kSun = 20;
  const Image<float> picture = picture_of([](int x, int y) { return x == kSun && y == kSun ? 1e6 : 0.0; });
  const std::vector<Vec2> places = random_places(4);
  const std::vector<double> values = interpolated(picture, places);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Vec2 away = (places[k] - Vec2(kSun, kSun)).cwiseAbs();
    if (away.maxCoeff() >= SplineTile::kReach) {
      EXPECT_EQ(values[k], 0) << places[k].transpose();
    }
  }
}

// Whatever passes the check is interpolated to a thousandth of the mean.
TEST(Spline, WhatFitsIsInterpolatedWell) {
  int fitting = 0;
  for (int k = 0; k < 200; ++k) {
    Random random(7, static_cast<std::uint64_t>(k));
    const double most = 0.03 + 0.25 * random.uniform(), contrast = 0.3 * random.uniform();
    double fx[4], fy[4], phase[4];
    for (int n = 0; n < 4; ++n) {
      fx[n] = most * (2 * random.uniform() - 1);
      fy[n] = most * (2 * random.uniform() - 1);
      phase[n] = 6.3 * random.uniform();
    }
    const auto light = [&](double x, double y) {
      double sum = 1;
      for (int n = 0; n < 4; ++n) {
        sum += contrast * std::sin(2 * std::numbers::pi * (fx[n] * x + fy[n] * y) + phase[n]);
      }
      return sum;
    };
    const Image<float> picture = picture_of(light);
    if (!fits_spline(picture.row(0), picture.stride(), {3, 3, kSide - 3, kSide - 3})) continue;
    ++fitting;
    const std::vector<Vec2> places = random_places(static_cast<std::uint64_t>(k));
    const std::vector<double> values = interpolated(picture, places);
    double squares = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      squares += std::pow(values[i] - light(places[i].x(), places[i].y()), 2);
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(places.size())), 1e-3) << "case " << k;
  }
  EXPECT_GT(fitting, 50) << "the check lets little through";
  EXPECT_LT(fitting, 190) << "the check lets everything through";
}

TEST(Spline, AnEdgeDoesNotFit) {
  const Image<float> edge = picture_of([](int x, int) { return x < 20 ? 1.0 : 2.0; });
  const Image<float> sill = picture_of([](int, int y) { return y < 20 ? 1.0 : 2.0; });
  const Image<float> black = picture_of([](int, int) { return 0.0; });
  const PixelBox box{3, 3, kSide - 3, kSide - 3};
  EXPECT_FALSE(fits_spline(edge.row(0), edge.stride(), box));
  EXPECT_FALSE(fits_spline(sill.row(0), sill.stride(), box));
  EXPECT_TRUE(fits_spline(edge.row(0), edge.stride(), {3, 3, 17, kSide - 3})) << "two pixels from the edge";
  EXPECT_TRUE(fits_spline(black.row(0), black.stride(), box));
}

}  // namespace
}  // namespace hdr::internal
