// Cameras do things to colours that no curve by channel explains; what one shot alone shows of a colour has moved.
// (tests/data/still_ghosts_test.cpp has the photographs.)
#include "libhdr/merge/internal/ghost_colours.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/random.h"

namespace hdr {
namespace {

using internal::ColourBins;
using internal::ColourMedians;
using internal::ColourMisfit;
using internal::ColourSample;

std::uint16_t bin_of(float red, float green, float blue, bool clipped = false) {
  const float levels[3] = {red, green, blue};
  return ColourBins::bin_of(levels, clipped);
}

TEST(GhostColours, BinsKnowRatiosLevelsAndClipping) {
  EXPECT_EQ(bin_of(0.5f, 0.5f, 0.5f), bin_of(0.6f, 0.6f, 0.6f));
  EXPECT_NE(bin_of(0.5f, 0.5f, 0.5f), bin_of(0.24f, 0.24f, 0.24f)) << "another octave";
  EXPECT_NE(bin_of(0.5f, 0.5f, 0.5f), bin_of(0.5f, 0.5f, 0.3f)) << "another colour";
  EXPECT_NE(bin_of(0.5f, 0.5f, 0.5f), bin_of(0.5f, 0.5f, 0.5f, true));
  for (const float level : {0.0f, 1e-12f, 1e-3f, 1.0f, 1.5f, 2.0f}) {
    EXPECT_LT(bin_of(level, 1 - level / 2, 0, true), ColourBins::kCount);
  }
  EXPECT_EQ(ColourBins::octave_of(1.0f), 0);
  EXPECT_EQ(ColourBins::octave_of(0.75f), 1);
  EXPECT_EQ(ColourBins::octave_of(0.25f), 2);
  EXPECT_EQ(ColourBins::kind_of(bin_of(0.5f, 0.5f, 0.5f), 2), 0u);
  EXPECT_EQ(ColourBins::kind_of(bin_of(0.5f, 0.5f, 0.125f), 2), 2u) << "two octaves less light than the others";
  EXPECT_EQ(ColourBins::kind_of(bin_of(0.5f, 0.5f, 0.125f), 0), 0u);
}

/// Colours 0 .. 9; in the last the shots differ by `odd`, in the eyes of one shot or of both.
struct Colours {
  std::vector<ColourSample> of_a, of_b;

  static std::uint16_t colour(int k) { return bin_of(0.5f, 0.5f, std::exp2(0.5f * static_cast<float>(4 - k))); }

  Colours(float odd, bool both, double incomparable = 0) {
    Random random(7, 1);
    for (int k = 0; k < 10; ++k) {
      for (int cell = 0; cell < 400; ++cell) {
        float value = 0.02f * static_cast<float>(random.normal()) + (k == 9 ? odd : 0);
        if (k == 9 && random.uniform() < incomparable) value = NAN;
        of_a.push_back({colour(k), value});
        // What moved is before things of the other colours.
        of_b.push_back({colour(k == 9 && !both ? cell % 9 : k), value});
      }
    }
  }
};

TEST(GhostColours, WhatBothShotsShowInOneColourIsTheCameras) {
  Colours seen(0.3f, true);
  const ColourMisfit misfit(1, seen.of_a, seen.of_b);
  EXPECT_NEAR(misfit.expected(seen.colour(9), seen.colour(9)).offset, 0.3, 0.02);
  EXPECT_NEAR(misfit.expected(seen.colour(0), seen.colour(0)).offset, 0, 0.01);
}

// Few of the colours are odd: one that was not seen is expected to be as the others are.
TEST(GhostColours, UnseenColoursAreAsWrongAsMostAre) {
  Colours seen(0.3f, true);
  const std::uint16_t unseen = bin_of(0.5f, 0.4f, 0.9f);
  const ColourMisfit right(1, seen.of_a, seen.of_b);
  EXPECT_EQ(right.expected(unseen, unseen).offset, 0);
  EXPECT_LT(right.expected(unseen, unseen).variance, 1e-4);
  for (auto* samples : {&seen.of_a, &seen.of_b}) {
    for (ColourSample& sample : *samples) sample.value += sample.bin % 3 == 0 ? 0.2f : -0.2f;
  }
  const ColourMisfit wrong(1, seen.of_a, seen.of_b);
  EXPECT_GT(wrong.expected(unseen, unseen).variance, 0.02);
}

TEST(GhostColours, WhatOnlyOneShotShowsInAColourHasMoved) {
  Colours seen(0.3f, false);
  const ColourMisfit misfit(1, seen.of_a, seen.of_b);
  for (int behind = 0; behind < 9; ++behind) {
    const ColourMisfit::Expected e = misfit.expected(seen.colour(9), seen.colour(behind));
    EXPECT_NEAR(e.offset, 0, 0.01) << behind;
    EXPECT_LT(e.variance, 1e-3) << behind;
  }
}

TEST(GhostColours, ColoursOfWhichManyCellsCannotBeComparedSayNothing) {
  Colours seen(0.3f, true, 0.5);
  const ColourMisfit misfit(1, seen.of_a, seen.of_b);
  EXPECT_EQ(misfit.expected(seen.colour(9), seen.colour(9)).offset, 0);
}

TEST(GhostColours, ThreeCellsSayLittle) {
  std::vector<ColourSample> few(3, {bin_of(0.5f, 0.5f, 0.5f), 1.0f}), same = few;
  EXPECT_TRUE(ColourMedians(few).bins().empty());
  const ColourMisfit misfit(1, few, same);
  EXPECT_EQ(misfit.expected(few[0].bin, few[0].bin).offset, 0);
  EXPECT_EQ(misfit.expected(few[0].bin, few[0].bin).variance, 0);
}

}  // namespace
}  // namespace hdr
