#include "libhdr/response/fragments.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/response/simulated.h"

namespace hdr {
namespace {

TEST(CurveFragments, LieOnTheCurveOnceShifted) {
  const Response truth = *response_from_name("film", 8);
  const Bracket bracket = test::simulate(truth, {});
  const auto fragments = curve_fragments(bracket, {}, truth, {}, 60);
  for (int c = 0; c < 3; ++c) {
    const auto& channel = fragments[static_cast<std::size_t>(c)];
    ASSERT_GE(channel.size(), 30u) << c;
    double squares = 0, low = INFINITY, high = -INFINITY;
    int count = 0;
    for (const CurveFragment& fragment : channel) {
      ASSERT_GE(fragment.codes.size(), 2u);
      ASSERT_EQ(fragment.codes.size(), fragment.ln_exposure.size());
      EXPECT_TRUE(std::is_sorted(fragment.ln_exposure.begin(), fragment.ln_exposure.end()));
      for (std::size_t k = 0; k < fragment.codes.size(); ++k) {
        const double off = truth.ln_exposure(c, fragment.codes[k]) - fragment.ln_radiance - fragment.ln_exposure[k];
        squares += off * off;
        ++count;
      }
      low = std::min(low, fragment.ln_radiance);
      high = std::max(high, fragment.ln_radiance);
    }
    EXPECT_LT(std::sqrt(squares / count), 0.03) << "channel " << c << ": as the fit's own rms";
    EXPECT_GT(high - low, 1) << "before the shift they are far apart";
  }
}

TEST(CurveFragments, MoreTimeIsLessLight) {
  const Response truth = *response_from_name("srgb", 8);
  const Bracket bracket = test::simulate(truth, {});
  std::vector<double> longer;
  for (const Photo& shot : bracket.shots) longer.push_back(1.5 * *shot.exposure.seconds);
  const auto labelled = curve_fragments(bracket, {}, truth, {}, 20);
  const auto refined = curve_fragments(bracket, {}, truth, longer, 20);
  ASSERT_EQ(labelled[1].size(), refined[1].size());
  for (std::size_t k = 0; k < labelled[1].size(); ++k) {
    EXPECT_NEAR(refined[1][k].ln_radiance, labelled[1][k].ln_radiance - std::log(1.5), 1e-9);
    EXPECT_NEAR(refined[1][k].ln_exposure[0], labelled[1][k].ln_exposure[0] + std::log(1.5), 1e-9);
  }
}

}  // namespace
}  // namespace hdr
