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

class RobertsonOf : public testing::TestWithParam<Camera> {};

// Single pixels are noisier than windows, and where a power law is darkest a code's worth of noise is a large share.
TEST_P(RobertsonOf, RecoversTheCameraThatTookTheShots) {
  const Camera camera = GetParam();
  const Response truth = *response_from_name(camera.response, camera.bits);
  Simulation simulation;
  simulation.seed = 21;
  const Calibration fit = calibrate_robertson(simulate(truth, simulation));
  double mean = 0;
  for (int c = 0; c < 3; ++c) mean += rms_error(fit.response, truth, c) / 3;
  EXPECT_LT(mean, camera.tolerance) << "rms of the fit " << fit.rms_log_error;
  EXPECT_TRUE(fit.converged);
  EXPECT_LT(fit.rms_log_error, 0.06);
  test::expect_a_response(fit.response, camera.bits);
  for (const auto& deviation : fit.deviation) {
    ASSERT_EQ(deviation.size(), truth.g[0].size());
    for (const double d : deviation) ASSERT_TRUE(d >= 0 && std::isfinite(d));
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, RobertsonOf,
                         testing::Values(Camera{"srgb", 8, 0.015}, Camera{"gamma:2.2", 8, 0.06},
                                         Camera{"linear", 8, 0.004}, Camera{"film", 8, 0.016},
                                         Camera{"linear", 16, 0.006}, Camera{"film", 12, 0.017}));

// Every pixel is two shots that differ by a factor of 2 of a linear camera: nothing is to be learnt, nothing may
// change.
TEST(CalibrateRobertson, AnExactLinearCameraIsAFixedPoint) {
  Simulation simulation;
  simulation.evs = {0, 1};
  Bracket bracket = simulate(linear_response(8), simulation);
  for (std::size_t j = 0; j < 2; ++j) {
    auto& codes = std::get<Image<std::uint8_t>>(bracket.shots[j].codes);
    for (int y = 0; y < codes.height(); ++y) {
      for (int k = 0; k < 3 * codes.width(); ++k) {
        codes.row(y)[k] = static_cast<std::uint8_t>((1 + (k / 3 + 7 * y) % 124) << j);
      }
    }
  }
  const Calibration fit = calibrate_robertson(bracket);
  EXPECT_NEAR(fit.rms_log_error, 0, 1e-12);
  for (const int code : {2, 60, 124, 200, 248})
    EXPECT_NEAR(std::exp(fit.response.g[0][static_cast<std::size_t>(code)]), code / 128.0, 1e-9) << code;
}

TEST(CalibrateRobertson, FollowsTheRegistration) {
  Simulation simulation;
  std::vector<Mat3> ref_from_photo(simulation.evs.size(), Mat3::Identity());
  for (std::size_t j = 0; j < ref_from_photo.size(); ++j) {
    ref_from_photo[j](0, 2) = 9.0 * (static_cast<double>(j % 3) - 1);
    ref_from_photo[j](1, 2) = 5.0 * (static_cast<double>(j % 2));
  }
  const Response truth = film_response(8);
  const Bracket bracket = simulate(truth, simulation, ref_from_photo);
  EXPECT_LT(rms_error(calibrate_robertson(bracket, ref_from_photo).response, truth, 1), 0.04);
}

TEST(CalibrateRobertson, ABlackChannelBorrowsTheOthersCurve) {
  Bracket bracket = simulate(srgb_response(8), {});
  test::blacken_channel(bracket, 2);
  const Calibration fit = calibrate_robertson(bracket);
  ASSERT_FALSE(fit.warnings.empty());
  EXPECT_NE(fit.warnings[0].find("blue"), std::string::npos) << fit.warnings[0];
  EXPECT_NEAR(fit.response.g[2][200], 0.5 * (fit.response.g[0][200] + fit.response.g[1][200]), 1e-12);
}

TEST(CalibrateRobertson, HopelessBracketsAreErrorsThatNameAFileAndARemedy) {
  test::expect_errors_for_hopeless_brackets([](const Bracket& bracket) { return calibrate_robertson(bracket); });
}

// 16-bit codes of a few pixels: the objective is nothing for whatever curve.
TEST(CalibrateRobertson, CodesThatAreMetOnceSayNothing) {
  Simulation simulation;
  simulation.evs = {0, 1};
  simulation.width = 7;
  simulation.height = 6;
  try {
    const Calibration fit = calibrate_robertson(simulate(*response_from_name("linear", 16), simulation));
    FAIL() << "a curve with a deviation of " << fit.deviation[0].front();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("met twice"), std::string::npos) << error.what();
  }
}

TEST(CalibrateRobertson, IsTheSameOnAnyNumberOfThreads) {
  const Bracket bracket = simulate(film_response(8), {});
  set_threads(1);
  const Calibration one = calibrate_robertson(bracket);
  set_threads(2);
  const Calibration two = calibrate_robertson(bracket);
  set_threads(0);
  EXPECT_EQ(one.response.g, two.response.g);
  EXPECT_EQ(one.deviation, two.deviation);
}

}  // namespace
}  // namespace hdr
