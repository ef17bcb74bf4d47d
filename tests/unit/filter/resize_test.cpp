#include "libhdr/filter/resize.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/support.h"

namespace hdr {
namespace {

double mean(const Image<float>& image) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < 3 * image.width(); ++x) sum += image.row(y)[x];
  }
  return sum / (3.0 * image.width() * image.height());
}

TEST(Resize, ShrinkingKeepsTheMeanAndConstantsStay) {
  const Image<float> scene = test::test_scene(120, 80, 6, 3);
  EXPECT_NEAR(mean(resize(scene, {40, 20})) / mean(scene), 1, 1e-5) << "an area mean keeps the energy";
  Image<float> grey(7, 5, 3);
  for (int y = 0; y < 5; ++y) std::fill(grey.row(y), grey.row(y) + 21, 3.0f);
  for (const Size size : {Size{3, 9}, Size{20, 2}, Size{1, 1}, Size{7, 5}}) {
    const Image<float> out = resize(grey, size);
    ASSERT_EQ(out.size(), size);
    EXPECT_NEAR(mean(out), 3, 1e-6);
  }
}

TEST(Resize, EnlargingIsBilinearBetweenPixelCentres) {
  Image<float> step(2, 1, 3);
  for (int c = 0; c < 3; ++c) step(1, 0, c) = 1;
  const Image<float> out = resize(step, {4, 1});
  EXPECT_FLOAT_EQ(out(0, 0), 0);
  EXPECT_FLOAT_EQ(out(1, 0), 0.25f);
  EXPECT_FLOAT_EQ(out(2, 0), 0.75f);
  EXPECT_FLOAT_EQ(out(3, 0), 1);
}

}  // namespace
}  // namespace hdr
