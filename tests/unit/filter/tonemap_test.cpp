#include "libhdr/filter/tonemap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/color.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

Image<float> grey(int width, int height, float value) {
  Image<float> map(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 3 * width; ++x) map.row(y)[x] = value;
  return map;
}

TEST(Tonemap, MeteringBringsGreyTo18Percent) {
  for (const float value : {1e-4f, 0.18f, 1.0f, 5000.0f}) {
    EXPECT_NEAR(metered_stops(grey(8, 8, value)), std::log2(0.18 / value), 1e-5);
  }
  EXPECT_EQ(metered_stops(grey(4, 4, 0)), 0) << "a black picture";
}

TEST(Tonemap, MeteringIgnoresTheEmptyPartOfAPicture) {
  Image<float> map = grey(8, 8, 2);
  for (int x = 0; x < 24; ++x) map.row(0)[x] = 0;
  EXPECT_NEAR(metered_stops(map), std::log2(0.09), 1e-6);
}

TEST(Tonemap, AStopMoreInThePictureIsAStopLessInTheExposure) {
  const Image<float> one = test::test_scene(60, 40, 14, 3);
  Image<float> two = one.clone();
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 180; ++x) two.row(y)[x] *= 4;
  const Image<std::uint8_t> a = tonemap(one, 1), b = tonemap(two, -1);
  for (int y = 0; y < 40; ++y) EXPECT_EQ(0, std::memcmp(a.row(y), b.row(y), a.row_samples())) << "row " << y;
}

TEST(Tonemap, BrighterIsNeverDarkerAndHighlightsStayApart) {
  Image<float> ramp(2000, 1, 3);
  for (int x = 0; x < 2000; ++x)
    for (int c = 0; c < 3; ++c) ramp(x, 0, c) = std::exp2(-8.0f + 0.008f * static_cast<float>(x));  // 16 stops
  const Image<std::uint8_t> codes = tonemap(ramp, 0);
  for (int x = 1; x < 2000; ++x) EXPECT_GE(codes(x, 0), codes(x - 1, 0)) << "at " << ramp(x, 0);
  EXPECT_EQ(codes(1999, 0), 255) << "the white is at the top";
  EXPECT_LT(codes(1700, 0), 255) << "49 stays apart from 256";
}

TEST(Tonemap, DarkTonesFollowSrgb) {
  // L / (1 + L) is L to first order.
  const Image<std::uint8_t> codes = tonemap(grey(2, 2, 0.01f), 0);
  EXPECT_NEAR(codes(0, 0), 255 * srgb_from_linear(0.01), 1);
}

TEST(Tonemap, AlphaIsTheFourthChannel) {
  Image<float> alpha(2, 1, 1);
  alpha(1, 0) = 0.5f;
  const Image<std::uint8_t> codes = tonemap(grey(2, 1, 1), 0, alpha);
  ASSERT_EQ(codes.channels(), 4);
  EXPECT_EQ(codes(0, 0, 3), 0);
  EXPECT_EQ(codes(1, 0, 3), 128);
}

TEST(Tonemap, WhatIsNoNumberIsBlackAndWhatIsInfiniteIsWhite) {
  Image<float> map = grey(4, 4, 0.18f);
  for (int c = 0; c < 3; ++c) {
    map(0, 0, c) = NAN;
    map(1, 0, c) = INFINITY;
  }
  EXPECT_NEAR(metered_stops(map), 0, 1e-6) << "the others alone are measured";
  for (const ToneOperator tone : {ToneOperator::kReinhard, ToneOperator::kFilmic, ToneOperator::kClip}) {
    for (const double stops : {0.0, 1000.0}) {
      const Image<std::uint8_t> codes = tonemap(map, stops, {}, tone);
      EXPECT_EQ(codes(0, 0), 0);
      EXPECT_EQ(codes(1, 0), 255);
    }
  }
  EXPECT_EQ(tonemap(map, 0, {}, ToneOperator::kLocal).size(), map.size());
}

}  // namespace
}  // namespace hdr
