// Shots that a hand moved, merged on the reference's grid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/merge/merge.h"
#include "libhdr/response/expose.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

constexpr Size kSize{200, 140};

/// A scene that is known between its pixels: waves down to seven pixels.
double radiance_at(double x, double y) {
  return std::exp2(std::sin(0.9 * x + 0.3 * y) * 0.4 + std::sin(0.05 * x - 0.11 * y) * 2 + 0.015 * (x - 100));
}

Image<float> view_through(const Mat3& scene_from_photo) {
  Image<float> view(kSize, 3);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const Vec2 p = (scene_from_photo * Vec3(x, y, 1)).hnormalized();
      std::fill_n(view.pixel(x, y), 3, static_cast<float>(radiance_at(p.x(), p.y())));
    }
  }
  return view;
}

Mat3 hand_shake(std::uint64_t seed, std::uint64_t shot) {
  Random random(seed, shot);
  const auto within = [&](double a) { return a * (2 * random.uniform() - 1); };
  const double angle = within(0.05);
  Mat3 m;
  m << std::cos(angle), -std::sin(angle), within(4), std::sin(angle), std::cos(angle), within(4), within(1e-4),
      within(1e-4), 1;
  return m;
}

struct Moved {
  Bracket bracket;
  Alignment alignment;
  Image<float> truth;  ///< of the reference
};

Moved hand_held(std::uint64_t seed, const Sensor& sensor) {
  Moved made;
  made.alignment.reference = 2;
  made.truth = view_through(Mat3::Identity());
  for (std::size_t k = 0; k < 5; ++k) {
    const Mat3 scene_from_photo = k == 2 ? Mat3(Mat3::Identity()) : hand_shake(seed, k);
    Exposure exposure;
    exposure.seconds = std::exp2(2.0 * (static_cast<double>(k) - 2));
    Photo photo = expose(view_through(scene_from_photo), exposure, sensor, 50 * seed + k);
    made.bracket.shots.push_back(std::move(photo));
    made.bracket.input_order.push_back(static_cast<int>(k));
    FrameAlignment frame;
    frame.ref_from_photo = scene_from_photo;
    made.alignment.frames.push_back(frame);
  }
  return made;
}

/// radiance exp(g) / H of scene value 1, in the unit of the middle shot (H = 1).
double map_per_scene(const Sensor& sensor, int channel) {
  return sensor.sensitivity * sensor.response.exposure(channel, std::ldexp(1.0, sensor.response.bits) - 1);
}

TEST(MovedShots, AreMergedThroughAnyHomographyWithoutBlur) {
  const Sensor sensor{gamma_response(8, 2.2), NoiseModel{}, 0.18};
  for (const WeightKind kind : {WeightKind::kVariance, WeightKind::kHat}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Moved made = hand_held(seed, sensor);
      MergeOptions options;
      options.weight = kind;
      const Merged merged = merge(made.bracket, made.alignment, sensor.response, options);
      std::vector<double> errors;
      for (int y = 0; y < kSize.height; ++y) {
        for (int x = 0; x < kSize.width; ++x) {
          const double truth = made.truth(x, y, 1) * map_per_scene(sensor, 1);
          errors.push_back(std::abs(std::log2(merged.map.rgb(x, y, 1) / truth)));
        }
      }
      std::sort(errors.begin(), errors.end());
      EXPECT_LT(errors[errors.size() / 2], 0.012);
      EXPECT_LT(errors[errors.size() * 99 / 100], 0.06) << "bilinear shares leave .08";
    }
  }
}

TEST(MovedShots, TheStandardDeviationKnowsThatMeansAreQuieter) {
  const Sensor sensor{linear_response(16), NoiseModel{500, 4}, 0.18};
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Moved made = hand_held(seed, sensor);
    MergeOptions options;
    options.uncertainty = true;
    options.noise = Noise{sensor.noise, sensor.noise, sensor.noise};
    options.weight = WeightKind::kVariance;
    const Merged merged = merge(made.bracket, made.alignment, sensor.response, options);
    double squares = 0, count = 0;
    for (int y = 10; y < kSize.height - 10; ++y) {
      for (int x = 10; x < kSize.width - 10; ++x) {
        const double truth = made.truth(x, y, 1) * map_per_scene(sensor, 1);
        squares += std::pow(std::min(5.0, (merged.map.rgb(x, y, 1) - truth) / merged.map.stddev(x, y, 1)), 2);
        ++count;
      }
    }
    EXPECT_NEAR(std::sqrt(squares / count), 1, 0.12) << "deviations in units of the one that was said";
  }
}

// A shot whose exposure time is 10 % off ends in the middle of a wall.
TEST(MovedShots, NoSeamShowsWhereAShotEnds) {
  Image<float> wall(400, 120, 3);
  for (int y = 0; y < 120; ++y) std::fill_n(wall.row(y), 1200, 0.5f);
  const Sensor sensor{linear_response(16), {1e9, 0}, 0.18};
  Bracket bracket;
  Alignment alignment;
  for (int k = 0; k < 2; ++k) {
    Exposure exposure;
    exposure.seconds = 1;
    bracket.shots.push_back(expose(wall, exposure, sensor, 1));
    if (k == 1) bracket.shots.back().exposure.seconds = 1.1;
    bracket.input_order.push_back(k);
    alignment.frames.emplace_back();
  }
  alignment.frames[1].ref_from_photo(0, 2) = -200;  // it shows the left half
  for (const WeightKind kind : {WeightKind::kVariance, WeightKind::kHat}) {
    MergeOptions options;
    options.weight = kind;
    options.noise = Noise{};
    const Merged merged = merge(bracket, alignment, sensor.response, options);
    const auto between = [&](int a, int b) {
      return std::abs(std::log2(merged.map.rgb(a, 60, 1) / merged.map.rgb(b, 60, 1)));
    };
    float step = 0;
    for (int x = 0; x + 1 < 400; ++x) step = std::max(step, between(x, x + 1));
    const float whole = between(100, 300);
    EXPECT_GT(whole, 0.03) << "the two do disagree";
    EXPECT_LT(step, whole / 2.5) << "a step from pixel to pixel";
  }
}

}  // namespace
}  // namespace hdr
