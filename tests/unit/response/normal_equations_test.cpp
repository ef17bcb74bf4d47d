#include "libhdr/response/internal/normal_equations.h"

#include <gtest/gtest.h>

#include "libhdr/response/internal/debevec_malik.h"
#include "libhdr/response/internal/observations.h"
#include "tests/unit/response/simulated.h"

namespace hdr {
namespace {

// Two ways to the same minimum: Ceres keeps every ln E as an unknown, the normal equations eliminate them.
TEST(NormalEquations, HaveTheSolutionThatCeresFinds) {
  for (const int bits : {8, 14}) {
    const Observations seen = sample_points(test::simulate(film_response(bits), {}), {}, 300);
    const Knots knots(bits, 0.25);
    const CodeWeights hat = CodeWeights::hat(bits);
    for (const double smoothness : {0.01, 1.0}) {
      const Eigen::VectorXd eliminated = NormalEquations(knots, hat, seen.codes[1], seen.ln_exposure).solve(smoothness);
      const CurveFit fitted = fit_curve(knots, hat, seen.codes[1], seen.ln_exposure, smoothness);
      // Where no point is, only smoothness speaks, and a trust region stops a little early.
      const auto seen_codes = seen.codes[1].array().isFinite();
      const double lowest = seen_codes.select(seen.codes[1].array(), INFINITY).minCoeff();
      const double highest = seen_codes.select(seen.codes[1].array(), -INFINITY).maxCoeff();
      double largest = 0;
      for (int k = 0; k < knots.count(); ++k) {
        if (knots.code(k) < lowest || knots.code(k) > highest) continue;
        largest = std::max(largest, std::abs(eliminated[k] - fitted.g[k]));
      }
      EXPECT_LT(largest, 1e-3) << bits << " bits, smoothness " << smoothness;
    }
  }
}

// Points halve the variance of g as their number doubles.
TEST(NormalEquations, DeviationFallsWithTheRootOfTheNumberOfPoints) {
  const Observations seen = sample_points(test::simulate(srgb_response(8), {}), {}, 300);
  const Knots knots(8);
  const CodeWeights hat = CodeWeights::hat(8);
  Eigen::MatrixXd twice(2 * seen.codes[0].rows(), seen.codes[0].cols());
  twice << seen.codes[0], seen.codes[0];
  constexpr double kSmoothness = 1e-3;
  const Eigen::VectorXd once =
      NormalEquations(knots, hat, seen.codes[0], seen.ln_exposure).deviation(kSmoothness, 0.01);
  const Eigen::VectorXd both = NormalEquations(knots, hat, twice, seen.ln_exposure).deviation(2 * kSmoothness, 0.01);
  EXPECT_NEAR(both[60] / once[60], std::sqrt(0.5), 1e-6);
  EXPECT_EQ(once[knots.middle()], 0);
}

}  // namespace
}  // namespace hdr
