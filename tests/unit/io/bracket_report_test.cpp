#include "libhdr/io/bracket_report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/color.h"

namespace hdr {
namespace {

/// A ramp of light from 2^-12 to 1 of what clips at 1 s, photographed for some times through sRGB.
Bracket ramp_bracket(const std::vector<double>& seconds, double darkest_stops = 12) {
  Bracket bracket;
  for (const double t : seconds) {
    Photo shot;
    shot.path = std::to_string(t) + ".png";
    shot.exposure.seconds = t;
    Image<std::uint8_t> codes(1200, 4, 3);
    for (int x = 0; x < 1200; ++x) {
      const double light = t * std::exp2(-darkest_stops * (1 - x / 1199.0));
      for (int y = 0; y < 4; ++y) {
        for (int c = 0; c < 3; ++c)
          codes(x, y, c) = static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(light)));
      }
    }
    shot.codes = std::move(codes);
    bracket.shots.push_back(std::move(shot));
  }
  return bracket;
}

TEST(BracketReport, StepsAndShares) {
  const BracketReport report = report_bracket(ramp_bracket({0.25, 1, 4}));
  ASSERT_EQ(report.shots.size(), 3u);
  EXPECT_DOUBLE_EQ(report.span_ev, 4);
  EXPECT_FALSE(report.shots[0].step);
  EXPECT_DOUBLE_EQ(report.shots[2].step.value(), 2);
  EXPECT_NEAR(report.shots[2].clipped, 2 / 12.0, 0.01) << "the brightest two of twelve stops";
  EXPECT_EQ(report.shots[0].clipped, 0);
  EXPECT_GT(report.shots[0].dark, report.shots[1].dark);
}

TEST(BracketReport, SaysWhichShotWouldHelp) {
  // Dark is below 2 % of the codes, that is 0.0015 of linear light: 9.3 stops down. Of the ramp's 12 stops a shot of 1
  // s loses 2.7, so 3 EV more reach them all.
  const BracketReport report = report_bracket(ramp_bracket({0.5, 1}));
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].find("one more shot at +3 EV (8 s) would cover the shadows"), 0u) << report.missing[0];
  const BracketReport deep = report_bracket(ramp_bracket({0.5, 1}, 40));
  ASSERT_EQ(deep.missing.size(), 1u);
  EXPECT_EQ(deep.missing[0].find("more shots from +1 EV"), 0u) << deep.missing[0];
  const BracketReport whole = report_bracket(ramp_bracket({0.5, 2, 8}));
  EXPECT_TRUE(whole.missing.empty()) << whole.missing[0];
  const BracketReport late = report_bracket(ramp_bracket({2, 8}));
  ASSERT_EQ(late.missing.size(), 1u);
  EXPECT_NE(late.missing[0].find("at -2 EV (0.5 s)"), std::string::npos) << late.missing[0];
  const BracketReport wide = report_bracket(ramp_bracket({0.5, 16}));
  ASSERT_EQ(wide.missing.size(), 1u);
  EXPECT_NE(wide.missing[0].find("5.0 EV apart"), std::string::npos) << wide.missing[0];
}

TEST(BracketReport, KnowsTheNominalTimesOfADial) {
  EXPECT_TRUE(report_bracket(ramp_bracket({1.0 / 60, 1.0 / 13, 0.3})).nominal_times);
  EXPECT_FALSE(report_bracket(ramp_bracket({1.0 / 64, 1.0 / 16, 0.25})).nominal_times) << "powers of two";
  EXPECT_FALSE(report_bracket(ramp_bracket({0.0123, 0.0531})).nominal_times) << "no dial has these";
}

}  // namespace
}  // namespace hdr
