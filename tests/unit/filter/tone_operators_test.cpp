// The operators for looking: what each keeps, what it may change.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/filter/internal/local_tone.h"
#include "libhdr/filter/tonemap.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

Image<float> grey_steps(const std::vector<float>& values, int each = 8) {
  Image<float> map(each * static_cast<int>(values.size()), 64, 3);
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      for (int c = 0; c < 3; ++c) map(x, y, c) = values[static_cast<std::size_t>(x / each)];
    }
  }
  return map;
}

TEST(ToneOperators, BrighterLightIsNeverDarkerAndBlackStaysBlack) {
  std::vector<float> values = {0};
  for (int k = 0; k < 24; ++k) values.push_back(std::exp2(static_cast<float>(k) - 12));
  const Image<float> map = grey_steps(values);
  for (const ToneOperator tone :
       {ToneOperator::kReinhard, ToneOperator::kFilmic, ToneOperator::kLocal, ToneOperator::kClip}) {
    const Image<std::uint8_t> codes = tonemap(map, 0, {}, tone);
    EXPECT_EQ(codes(2, 30, 1), 0);
    for (int x = 12; x < map.width(); x += 8) {
      EXPECT_GE(codes(x, 30, 1), codes(x - 8, 30, 1)) << "operator " << static_cast<int>(tone) << ", step " << x / 8;
    }
  }
}

TEST(ToneOperators, FilmicMeetsItsPublishedWhiteAndClipIsSrgb) {
  // [Hable10]: 11.2 after the exposure bias of 2 is white.
  const Image<float> map = grey_steps({5.6f, 0.18f});
  EXPECT_EQ(tonemap(map, 0, {}, ToneOperator::kFilmic)(4, 4, 0), 255);
  EXPECT_LT(tonemap(map, -0.1, {}, ToneOperator::kFilmic)(4, 4, 0), 255);
  EXPECT_EQ(tonemap(map, 0, {}, ToneOperator::kClip)(12, 4, 0), std::lround(255 * srgb_from_linear(0.18)));
  EXPECT_EQ(tonemap(map, 1, {}, ToneOperator::kClip)(12, 4, 0), std::lround(255 * srgb_from_linear(0.36)));
}

TEST(ToneOperators, BilateralKeepsAnEdgeAndSmoothsWhatIsSmall) {
  Image<float> steps(200, 100, 1);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) steps(x, y) = (x < 100 ? 0.0f : 4.0f) + 0.05f * static_cast<float>((x + y) % 2);
  }
  const Image<float> smooth = internal::bilateral(steps, 6, 0.4);
  for (int x = 90; x < 110; ++x) EXPECT_NEAR(smooth(x, 50), x < 100 ? 0.025 : 4.025, 0.01) << x;
}

TEST(ToneOperators, LocalShowsDetailInSunAndShadeAtOnce) {
  // Two halves 10 stops apart, with the same 20 % texture.
  Image<float> map(256, 128, 3);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      for (int c = 0; c < 3; ++c) map(x, y, c) = (x < 128 ? 1.0f : 1024.0f) * (((x / 2) % 2) ? 1.0f : 1.2f);
    }
  }
  const Image<std::uint8_t> codes = tonemap(map, metered_stops(map), {}, ToneOperator::kLocal);
  const int dark = std::abs(codes(40, 64, 1) - codes(42, 64, 1)),
            bright = std::abs(codes(200, 64, 1) - codes(202, 64, 1));
  EXPECT_GT(dark, 6);
  EXPECT_GT(bright, 6);
  EXPECT_GT(codes(200, 64, 1), codes(40, 64, 1));
}

TEST(FalseColour, OneColourAStopAndALegendBelow) {
  const Image<float> map = grey_steps({0.18f * 0.26f, 0.18f * 0.4f, 0.18f * 1.1f, 0.18f * 1.9f, 0.18f * 2.1f}, 40);
  const FalseColour colours = false_colour(map, 0);
  EXPECT_EQ(colours.lowest, -2);
  EXPECT_EQ(colours.highest, 2);
  EXPECT_GT(colours.picture.height(), 64);
  EXPECT_EQ(colours.picture.width(), 200);
  const auto colour = [&](int x, int y) {
    return std::array{colours.picture(x, y, 0), colours.picture(x, y, 1), colours.picture(x, y, 2)};
  };
  EXPECT_EQ(colour(90, 10), colour(130, 10)) << "1.1 and 1.9 times grey are one stop";
  EXPECT_NE(colour(10, 10), colour(90, 10));
  EXPECT_EQ(colour(10, 10), colour(50, 10)) << "0.26 and 0.4: both between -2 and -1";
  EXPECT_EQ(colour(10, 10), colour(1, 65)) << "the legend's first patch is the lowest stop";
  EXPECT_EQ(colour(170, 10), colour(198, 65));
  const FalseColour brighter = false_colour(map, 3);
  EXPECT_EQ(brighter.lowest, 1);
  EXPECT_EQ(false_colour(grey_steps({0}), 0).picture(3, 3, 0), 0) << "black";
}

}  // namespace
}  // namespace hdr
