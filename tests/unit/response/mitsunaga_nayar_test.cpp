#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/response/calibrate.h"
#include "tests/unit/response/hopeless.h"

namespace hdr {
namespace {

using test::rms_error;
using test::simulate;
using test::Simulation;

struct Camera {
  const char* response;
  int bits;
  double tolerance;  ///< of the rms over codes 5 .. 250, mean of the channels, ln: twice what other seeds give
};

void PrintTo(const Camera& c, std::ostream* out) {
  *out << c.response << ", " << c.bits << " bits";
}

class MitsunagaNayarOf : public testing::TestWithParam<Camera> {};

// The objective counts errors of exposure, not of its logarithm, and knows little of the darkest codes.
TEST_P(MitsunagaNayarOf, RecoversTheCameraThatTookTheShots) {
  const Camera camera = GetParam();
  const Response truth = *response_from_name(camera.response, camera.bits);
  Simulation simulation;
  simulation.seed = 31;
  const Calibration fit = calibrate_mitsunaga_nayar(simulate(truth, simulation));
  double mean = 0;
  for (int c = 0; c < 3; ++c) mean += rms_error(fit.response, truth, c) / 3;
  EXPECT_LT(mean, camera.tolerance) << "rms of the fit " << fit.rms_log_error;
  EXPECT_TRUE(fit.converged);
  EXPECT_LT(fit.rms_log_error, 0.006);
  test::expect_a_response(fit.response, camera.bits);
  for (const auto& deviation : fit.deviation) {
    ASSERT_EQ(deviation.size(), truth.g[0].size());
    for (const double d : deviation) ASSERT_TRUE(d >= 0 && std::isfinite(d));
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, MitsunagaNayarOf,
                         testing::Values(Camera{"srgb", 8, 0.022}, Camera{"gamma:2.2", 8, 0.17},
                                         Camera{"linear", 8, 0.002}, Camera{"film", 8, 0.006},
                                         Camera{"linear", 16, 0.002}, Camera{"film", 12, 0.006}));

// A polynomial of the third degree is in the family: all of it is found, where codes are fine.
TEST(CalibrateMitsunagaNayar, FindsAPolynomial) {
  Response truth = linear_response(16);
  for (auto& g : truth.g) {
    for (std::size_t k = 1; k < g.size(); ++k) {
      const double m = truth.code_from_level(static_cast<int>(k)) / 65535;
      g[k] = std::log(0.3 * m + 0.2 * m * m + 0.5 * m * m * m);
    }
    g[0] = std::log(0.3 * 0.25 / 65535);
    const double middle = g[g.size() / 2];
    for (double& value : g) value -= middle;
  }
  Simulation simulation;
  simulation.noise.full_well = 1e8;
  simulation.noise.read_noise = 1;
  const Calibration fit = calibrate_mitsunaga_nayar(simulate(truth, simulation));
  for (int c = 0; c < 3; ++c) EXPECT_LT(rms_error(fit.response, truth, c), 0.003) << "channel " << c;
}

// Shutters that err by a few per cent: the alternation finds each, but for their mean and slope.
TEST(CalibrateMitsunagaNayar, RefinesTimes) {
  Simulation simulation;
  simulation.evs = {-6, -4.5, -3, -1.5, 0, 1.5, 3, 4.5, 6};
  const Response truth = srgb_response(8);
  Bracket bracket = simulate(truth, simulation);
  const std::vector<double> errors = {0.02, -0.04, 0.05, -0.02, -0.02, 0.02, -0.05, 0.04, 0.0};
  std::vector<double> given;
  for (std::size_t j = 0; j < errors.size(); ++j) {
    given.push_back(*bracket.shots[j].exposure.seconds * std::exp(errors[j]));
    bracket.shots[j].exposure.seconds = given.back();
  }
  const Calibration as_given = calibrate_mitsunaga_nayar(bracket);
  EXPECT_EQ(as_given.seconds, given);
  const Calibration fit = calibrate_mitsunaga_nayar(bracket, {}, {.refine_times = true});
  double before = 0, after = 0, slope = 0;
  for (std::size_t j = 0; j < errors.size(); ++j) {
    const double correction = std::log(fit.seconds[j] / given[j]);
    before += errors[j] * errors[j];
    after += (errors[j] + correction) * (errors[j] + correction);
    slope += correction * simulation.evs[j];
  }
  EXPECT_LT(after, 0.1 * before) << "of the sum of squares";
  EXPECT_NEAR(slope, 0, 0.03) << "the slope is not a shutter's error";
  EXPECT_TRUE(fit.converged);
  EXPECT_LT(fit.rms_log_error, 0.5 * as_given.rms_log_error);
}

TEST(CalibrateMitsunagaNayar, FollowsTheRegistration) {
  Simulation simulation;
  std::vector<Mat3> ref_from_photo(simulation.evs.size(), Mat3::Identity());
  for (std::size_t j = 0; j < ref_from_photo.size(); ++j) {
    ref_from_photo[j](0, 2) = 9.0 * (static_cast<double>(j % 3) - 1);
    ref_from_photo[j](1, 2) = 5.0 * (static_cast<double>(j % 2));
  }
  const Response truth = film_response(8);
  const Bracket bracket = simulate(truth, simulation, ref_from_photo);
  EXPECT_LT(rms_error(calibrate_mitsunaga_nayar(bracket, ref_from_photo).response, truth, 1), 0.04);
}

TEST(CalibrateMitsunagaNayar, ABlackChannelBorrowsTheOthersCurve) {
  Bracket bracket = simulate(srgb_response(8), {});
  test::blacken_channel(bracket, 2);
  const Calibration fit = calibrate_mitsunaga_nayar(bracket);
  ASSERT_FALSE(fit.warnings.empty());
  EXPECT_NE(fit.warnings[0].find("blue"), std::string::npos) << fit.warnings[0];
  EXPECT_NEAR(fit.response.g[2][200], 0.5 * (fit.response.g[0][200] + fit.response.g[1][200]), 1e-12);
}

TEST(CalibrateMitsunagaNayar, HopelessBracketsAreErrorsThatNameAFileAndARemedy) {
  test::expect_errors_for_hopeless_brackets([](const Bracket& bracket) { return calibrate_mitsunaga_nayar(bracket); });
}

TEST(CalibrateMitsunagaNayar, IsTheSameOnAnyNumberOfThreads) {
  const Bracket bracket = simulate(film_response(8), {});
  set_threads(1);
  const Calibration one = calibrate_mitsunaga_nayar(bracket);
  set_threads(2);
  const Calibration two = calibrate_mitsunaga_nayar(bracket);
  set_threads(0);
  EXPECT_EQ(one.response.g, two.response.g);
  EXPECT_EQ(one.deviation, two.deviation);
}

}  // namespace
}  // namespace hdr
