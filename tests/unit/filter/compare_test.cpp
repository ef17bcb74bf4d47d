// Errors that are known by construction.
#include "libhdr/filter/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/support.h"

namespace hdr {
namespace {

Image<float> scaled(View<const float> map, const std::array<float, 3>& factor) {
  Image<float> out(map.size(), 3);
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x)
      for (int c = 0; c < 3; ++c) out(x, y, c) = map(x, y, c) * factor[static_cast<std::size_t>(c)];
  return out;
}

TEST(Compare, EqualMapsHaveNoError) {
  const Image<float> map = test::test_scene(40, 30, 12, 1);
  const Comparison c = compare(map, map, CompareScale::kNone);
  EXPECT_EQ(c.rel_rmse, 0);
  EXPECT_EQ(c.median_abs_log2, 0);
  EXPECT_EQ(c.p99_abs_log2, 0);
  EXPECT_EQ(c.max_abs, 0);
}

TEST(Compare, ScalesAreFoundAndRemoved) {
  const Image<float> b = test::test_scene(40, 30, 12, 2);
  const Image<float> tinted = scaled(b, {0.25f, 2.0f, 8.0f});
  const Comparison channel = compare(tinted, b, CompareScale::kChannel);
  EXPECT_NEAR(channel.scale[0], 4, 1e-5);
  EXPECT_NEAR(channel.scale[1], 0.5, 1e-5);
  EXPECT_NEAR(channel.scale[2], 0.125, 1e-5);
  EXPECT_LT(channel.p99_abs_log2, 1e-5);
  EXPECT_LT(channel.rel_rmse, 1e-5);

  const Comparison none = compare(scaled(b, {2, 2, 2}), b, CompareScale::kNone);
  EXPECT_NEAR(none.median_abs_log2, 1, 1e-6) << "twice as bright is one stop";
  EXPECT_NEAR(none.rel_rmse, 1, 1e-6);
  const Comparison global = compare(scaled(b, {2, 2, 2}), b, CompareScale::kGlobal);
  EXPECT_NEAR(global.scale[1], 0.5, 1e-6);
  EXPECT_LT(global.rel_rmse, 1e-6);
}

TEST(Compare, MedianAndPercentileAreExact) {
  // b = 1, a = 2^k with k = 1 .. 100 in some order: |log2| takes each of those once.
  Image<float> a(100, 1, 1), b(100, 1, 1);
  for (int k = 0; k < 100; ++k) {
    a(k, 0) = std::exp2(static_cast<float>((k * 37) % 100 + 1));
    b(k, 0) = 1;
  }
  const Comparison c = compare(a, b, CompareScale::kNone);
  EXPECT_DOUBLE_EQ(c.median_abs_log2, 50.5);
  EXPECT_DOUBLE_EQ(c.p99_abs_log2, 99);
}

TEST(Compare, NonFiniteSamplesAreCountedAndLeftOut) {
  Image<float> a(4, 1, 3), b(4, 1, 3);
  for (int x = 0; x < 4; ++x)
    for (int c = 0; c < 3; ++c) a(x, 0, c) = b(x, 0, c) = 1;
  a(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
  a(1, 0, 2) = std::numeric_limits<float>::infinity();
  b(2, 0, 1) = -std::numeric_limits<float>::infinity();
  const Comparison c = compare(a, b, CompareScale::kGlobal);
  EXPECT_EQ(c.nonfinite[0], 2);
  EXPECT_EQ(c.nonfinite[1], 1);
  EXPECT_EQ(c.rel_rmse, 0);
  EXPECT_EQ(c.max_abs, 0);
}

TEST(Compare, MaskedPixelsDoNotCount) {
  Image<float> a(2, 1, 3), b(2, 1, 3);
  Image<std::uint8_t> mask(2, 1, 1);
  mask(1, 0) = 255;
  for (int c = 0; c < 3; ++c) {
    a(0, 0, c) = 99;
    b(0, 0, c) = 1;
    a(1, 0, c) = 3;
    b(1, 0, c) = 2;
  }
  const Comparison masked = compare(a, b, CompareScale::kNone, mask);
  EXPECT_EQ(masked.max_abs, 1);
  EXPECT_NEAR(masked.median_abs_log2, std::log2(1.5), 1e-7);
}

TEST(Compare, BlackMapsAreNoDivisionByZero) {
  Image<float> black(3, 3, 3), grey(3, 3, 3);
  grey(1, 1, 1) = 1;
  EXPECT_EQ(compare(black, black, CompareScale::kChannel).rel_rmse, 0);
  EXPECT_TRUE(std::isinf(compare(grey, black, CompareScale::kNone).rel_rmse));
  EXPECT_EQ(compare(black, grey, CompareScale::kNone).rel_rmse, 1);
}

TEST(Compare, DifferentSizesAreAnError) {
  EXPECT_THROW(compare(Image<float>(2, 2, 3), Image<float>(2, 3, 3), CompareScale::kNone), Error);
  EXPECT_THROW(compare(Image<float>(2, 2, 3), Image<float>(2, 2, 1), CompareScale::kNone), Error);
  const Image<std::uint8_t> mask(1, 2, 1);
  EXPECT_THROW(compare(Image<float>(2, 2, 3), Image<float>(2, 2, 3), CompareScale::kNone, mask), Error);
}

}  // namespace
}  // namespace hdr
