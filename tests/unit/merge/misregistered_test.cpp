#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/merge/merge.h"
#include "libhdr/response/expose.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

TEST(Merge, AShotThatCouldNotBeRegisteredIsLeftOutAndSaidSo) {
  const Image<float> scene = test::test_scene(90, 60, 6, 11);
  Sensor sensor{srgb_response(8), {}, 0.2};
  Bracket bracket;
  for (const double seconds : {0.25, 1.0, 4.0}) {
    bracket.shots.push_back(expose(scene, {seconds, std::nullopt, std::nullopt, 0}, sensor, bracket.shots.size()));
    bracket.input_order.push_back(static_cast<int>(bracket.input_order.size()));
  }
  Alignment alignment = no_alignment(bracket);
  alignment.reference = 1;
  alignment.frames[1].residual_px = 5;  // of the reference it means nothing
  alignment.frames[2].residual_px = 0.4;
  EXPECT_TRUE(merge(bracket, alignment, sensor.response).frames[2].used) << "a fraction of a pixel is no reason";
  alignment.frames[2].residual_px = 3;
  const Merged merged = merge(bracket, alignment, sensor.response);
  EXPECT_TRUE(merged.frames[0].used);
  EXPECT_TRUE(merged.frames[1].used);
  EXPECT_FALSE(merged.frames[2].used);
  EXPECT_NE(merged.frames[2].skipped.find("3.0 px"), std::string::npos) << merged.frames[2].skipped;

  bracket.shots.pop_back();
  alignment.frames.pop_back();
  Bracket two = std::move(bracket);
  const Merged without = merge(two, alignment, sensor.response);
  // The unit is that of the middle shot, which the third one moved: the same radiance in another unit.
  const double unit = merged.exposure_unit / without.exposure_unit;
  EXPECT_NEAR(merged.map.rgb(30, 20, 1), without.map.rgb(30, 20, 1) * unit, 1e-5 * merged.map.rgb(30, 20, 1));
}

/// Plaster with a lamp that clips in all shots but the shortest.
Image<float> lamp_scene() {
  Image<float> scene(120, 80, 3);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      const float wall = 0.5f + 0.3f * std::sin(0.7f * static_cast<float>(x)) * std::cos(0.6f * static_cast<float>(y));
      std::fill_n(scene.pixel(x, y), 3, std::hypot(x - 60, y - 40) < 12 ? 60.0f : wall);
    }
  }
  return scene;
}

struct Lamp {
  Sensor sensor{srgb_response(8), {}, 0.2};
  Image<float> scene = lamp_scene();
  Bracket bracket;
  Alignment alignment;
  static constexpr double kOff_px = 3;

  /// The shortest shot has moved, and registration has not seen it but knows its doubt.
  explicit Lamp(double lamp_seconds = 1.0 / 32) {
    Mat3 moved = Mat3::Identity();
    moved(0, 2) = kOff_px;
    for (const double seconds : {lamp_seconds, 0.5, 2.0}) {
      const Image<float> view = bracket.shots.empty() ? shake(scene, moved) : scene.clone();
      bracket.shots.push_back(expose(view, {seconds, std::nullopt, std::nullopt, 0}, sensor, bracket.shots.size()));
      bracket.input_order.push_back(static_cast<int>(bracket.input_order.size()));
    }
    alignment = no_alignment(bracket);
    alignment.reference = 1;
    alignment.frames[0].residual_px = kOff_px;
  }
};

TEST(Merge, AShorterShotThatCouldNotBeRegisteredMeasuresOnlyWhatClipsInAllOthers) {
  for (const WeightKind weight : {WeightKind::kHat, WeightKind::kVariance}) {
    const Lamp lamp;
    MergeOptions options;
    options.weight = weight;
    options.uncertainty = true;
    const Merged merged = merge(lamp.bracket, lamp.alignment, lamp.sensor.response, options);
    EXPECT_TRUE(merged.frames[0].used);
    EXPECT_NE(merged.frames[0].limited.find("3.0 px"), std::string::npos) << merged.frames[0].limited;
    EXPECT_EQ(merged.frames[1].limited, "");
    // The two shots that are registered, alone.
    Lamp two;
    two.bracket.shots.erase(two.bracket.shots.begin());
    two.alignment.frames.erase(two.alignment.frames.begin());
    two.alignment.reference = 0;
    options.exposure_unit = merged.exposure_unit;
    const Merged without = merge(two.bracket, two.alignment, two.sensor.response, options);
    const double map_per_scene = 0.2 * lamp.sensor.response.exposure(1, 255) * merged.exposure_unit;
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 120; ++x) {
        const double distance = std::hypot(x - 60, y - 40);
        if (distance < 11 - Lamp::kOff_px) {
          EXPECT_NEAR(merged.map.rgb(x, y, 1) / (60 * map_per_scene), 1, 0.05) << x << "," << y;
          EXPECT_EQ(merged.flags(x, y), 0) << "measured";
          EXPECT_LT(merged.map.stddev(x, y, 1), 0.05 * merged.map.rgb(x, y, 1));
          EXPECT_EQ(without.flags(x, y), kClippedFlag);
        } else if (distance > 13) {
          for (int c = 0; c < 3; ++c) ASSERT_EQ(merged.map.rgb(x, y, c), without.map.rgb(x, y, c)) << x << "," << y;
        }
        // The edge, where it shows the wall: what the others clipped at is a lower bound all the same.
        EXPECT_GE(merged.map.rgb(x, y, 1), 0.999f * without.map.rgb(x, y, 1));
      }
    }
  }
}

TEST(Merge, AShorterShotThatNoPixelNeedsIsLeftOut) {
  const Lamp lamp;
  Bracket bracket;
  bracket.shots.push_back(expose(lamp.scene, {1.0 / 64, std::nullopt, std::nullopt, 0}, lamp.sensor, 1));
  bracket.shots.push_back(expose(lamp.scene, {1.0 / 32, std::nullopt, std::nullopt, 0}, lamp.sensor, 2));
  bracket.input_order = {0, 1};
  Alignment alignment = no_alignment(bracket);
  alignment.reference = 1;
  alignment.frames[0].residual_px = 3;
  const Merged merged = merge(bracket, alignment, lamp.sensor.response);
  EXPECT_FALSE(merged.frames[0].used);
  EXPECT_NE(merged.frames[0].skipped.find("3.0 px"), std::string::npos) << merged.frames[0].skipped;
}

}  // namespace
}  // namespace hdr
