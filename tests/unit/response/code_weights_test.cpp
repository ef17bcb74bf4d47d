#include "libhdr/response/internal/code_weights.h"

#include <gtest/gtest.h>

#include "libhdr/response/calibrate.h"
#include "libhdr/response/internal/observations.h"
#include "tests/unit/response/simulated.h"

namespace hdr {
namespace {

const Eigen::MatrixXd kNoCodes;

TEST(CodeWeights, TheHatIsOneInTheMiddleAndPositiveAtTheEnds) {
  for (const int bits : {8, 12, 16}) {
    const double max_code = std::ldexp(1.0, bits) - 1;
    const CodeWeights hat = CodeWeights::hat(bits);
    EXPECT_NEAR(hat.at(0.5 * max_code), 1, 0.01) << bits;
    EXPECT_NEAR(hat.at(0.2 * max_code), 0.4, 1e-3) << bits;
    EXPECT_NEAR(hat.at(0.8 * max_code), 0.4, 1e-3) << bits;
    EXPECT_GT(hat.at(0), 0) << bits;
    EXPECT_GT(hat.at(max_code), 0) << bits;
  }
}

// A linear camera: ln of the code. Few electrons: their noise goes with the root of the light, and the weight too.
TEST(CodeWeights, GoWithTheRootOfTheLightWhereItsNoiseRules) {
  const CodeWeights weights = CodeWeights::from_noise(linear_response(16), 1, {50, 0, 0}, kNoCodes);
  EXPECT_NEAR(weights.at(40000) / weights.at(10000), 2, 0.01);
  EXPECT_NEAR(weights.at(60000), std::sqrt(9 * 50 * 60000.0 / 65535), 0.1) << "of a window of nine pixels";
}

// Many electrons, coarse codes: a rounding error of the same size everywhere, so a weight that goes with the code.
TEST(CodeWeights, GoWithTheCodeWhereRoundingRules) {
  const CodeWeights weights = CodeWeights::from_noise(linear_response(8), 1, {1e9, 0, 0}, kNoCodes);
  EXPECT_NEAR(weights.at(8) / weights.at(4), 2, 0.01);
  EXPECT_NEAR(weights.at(4), 4 * std::sqrt(12.0), 0.05);
  const CodeWeights compressed = CodeWeights::from_noise(linear_response(8), 1, {1e9, 0, 1}, kNoCodes);
  EXPECT_NEAR(compressed.at(10), 10 / std::sqrt(1 + 1.0 / 12), 0.1) << "compression's code of noise besides";
}

// A steep curve says little of the light: where g rises twice as fast with the code, the weight of its rounding halves.
TEST(CodeWeights, FallWithTheSlopeOfTheCurve) {
  const NoiseModel noise{1e9, 0, 0};
  const CodeWeights linear = CodeWeights::from_noise(linear_response(8), 1, noise, kNoCodes);
  const CodeWeights gamma = CodeWeights::from_noise(gamma_response(8, 2), 1, noise, kNoCodes);
  EXPECT_NEAR(linear.at(8) / gamma.at(8), 2, 0.02);
}

TEST(CodeWeights, OfTheCodesSeenHaveTheSumOfSquaresOfTheHat) {
  const Eigen::MatrixXd codes{{3, 20.5, NAN}, {90, 200, 246}};
  const CodeWeights hat = CodeWeights::hat(8);
  const CodeWeights weights = CodeWeights::from_noise(srgb_response(8), 0, {}, codes);
  double sum = 0, hat_sum = 0;
  for (const double code : codes.reshaped()) {
    if (std::isnan(code)) continue;
    sum += weights.at(code) * weights.at(code);
    hat_sum += hat.at(code) * hat.at(code);
  }
  EXPECT_NEAR(sum, hat_sum, 1e-9 * hat_sum);
}

// What they are for. By the hat's weights, and judged against ln(code + 1/2), the mean error was .004.
TEST(CodeWeights, LetDarkCodesBeFound) {
  double mean = 0;
  for (const std::uint64_t seed : {1, 2}) {
    test::Simulation simulation;
    simulation.width = 900;
    simulation.height = 600;
    simulation.evs = {-4, -3, -2, -1, 0, 1, 2, 3, 4};
    simulation.seed = seed;
    const Response truth = gamma_response(8, 2.2);
    const Calibration fit = calibrate_debevec_malik(test::simulate(truth, simulation));
    for (int c = 0; c < 3; ++c) mean += test::rms_error(fit.response, truth, c) / 6;
  }
  EXPECT_LT(mean, 0.002);
}

// A linear camera in steps of 2 EV, which leave waves open: a smoothness below 1 would let them in (errors of .03 to
// .1).
TEST(CodeWeights, BuyNoWavesWhereStepsAreUniform) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    test::Simulation simulation;
    simulation.evs = {-8, -6, -4, -2, 0, 2, 4, 6};
    simulation.seed = seed;
    const Response truth = linear_response(8);
    const Calibration fit = calibrate_debevec_malik(test::simulate(truth, simulation));
    EXPECT_GE(fit.smoothness, 1);
    for (int c = 0; c < 3; ++c) {
      EXPECT_LT(test::rms_error(fit.response, truth, c), 0.005) << "seed " << seed << ", channel " << c;
    }
  }
}

// Which windows are taken near white does not depend on their noise: against a noisier and longer partner, the codes of
// shots that are 2 EV apart keep their ratio. (Asking that no code of a window be near white took the windows whose
// noise is low, a code and more below their light.)
TEST(SamplePoints, DoNotChooseTheNoiseNearWhite) {
  test::Simulation simulation;
  simulation.noise = {3000, 5, 0};
  simulation.evs = {-2, 0};
  double sum = 0, count = 0;
  for (simulation.seed = 1; simulation.seed <= 4; ++simulation.seed) {
    const Observations seen = sample_points(test::simulate(linear_response(8), simulation), {}, 20000);
    for (const Eigen::MatrixXd& codes : seen.codes) {
      for (Eigen::Index i = 0; i < codes.rows(); ++i) {
        if (!(codes(i, 1) > 225)) continue;
        sum += codes(i, 1) - 4 * codes(i, 0);
        ++count;
      }
    }
  }
  ASSERT_GT(count, 200);
  EXPECT_NEAR(sum / count, 0, 0.5) << "of " << count << " windows";
}

}  // namespace
}  // namespace hdr
