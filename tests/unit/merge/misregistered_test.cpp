#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hdr
