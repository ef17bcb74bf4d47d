#include "libhdr/response/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "tests/unit/response/simulated.h"

namespace hdr {
namespace {

using test::rms_error;
using test::simulate;
using test::Simulation;

/// Saves the cross-validation where it is not what is tested.
const CalibrateOptions kQuick{.smoothness = 0.01};

struct Camera {
  const char* response;
  int bits;
  double tolerance;  ///< mean over the channels of the rms, ln
  std::uint64_t seed;
};

void PrintTo(const Camera& c, std::ostream* out) {
  *out << c.response << ", " << c.bits << " bits, seed " << c.seed;
}

class Calibrate : public testing::TestWithParam<Camera> {};

// Known truth. The tolerances are twice what other seeds give, and include light noise but no JPEG.
TEST_P(Calibrate, RecoversTheCameraThatTookTheShots) {
  const Camera camera = GetParam();
  const Response truth = *response_from_name(camera.response, camera.bits);
  Simulation simulation;
  simulation.seed = camera.seed;
  const Calibration fit = calibrate_debevec_malik(simulate(truth, simulation));
  double mean = 0;
  for (int c = 0; c < 3; ++c) mean += rms_error(fit.response, truth, c) / 3;
  EXPECT_LT(mean, camera.tolerance) << "smoothness " << fit.smoothness << ", rms of the fit " << fit.rms_log_error;
  EXPECT_TRUE(fit.converged);
  EXPECT_LT(fit.rms_log_error, 0.03);
  EXPECT_EQ(fit.response.bits, camera.bits);
  for (const auto& curve : fit.response.g) {
    EXPECT_EQ(curve.size(), truth.g[0].size());
    EXPECT_EQ(curve[curve.size() / 2], 0) << "g(2^(bits-1)) = 0";
    EXPECT_TRUE(std::is_sorted(curve.begin(), curve.end()));
    EXPECT_TRUE(std::isfinite(curve.front()));
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, Calibrate,
                         testing::Values(Camera{"srgb", 8, 0.006, 1}, Camera{"srgb", 8, 0.006, 2},
                                         Camera{"gamma:2.2", 8, 0.012, 3}, Camera{"gamma:1.8", 8, 0.012, 4},
                                         Camera{"linear", 8, 0.004, 5}, Camera{"film", 8, 0.006, 6},
                                         Camera{"film", 8, 0.006, 7}, Camera{"srgb", 16, 0.01, 8},
                                         Camera{"linear", 16, 0.016, 9}, Camera{"film", 12, 0.02, 10}));

TEST(CalibrateDebevecMalik, IsTheSameOnAnyNumberOfThreads) {
  const Bracket bracket = simulate(film_response(8), {});
  set_threads(1);
  const Calibration one = calibrate_debevec_malik(bracket);
  set_threads(2);
  const Calibration two = calibrate_debevec_malik(bracket);
  set_threads(0);
  EXPECT_EQ(one.response.g, two.response.g);
  EXPECT_EQ(one.smoothness, two.smoothness);
}

TEST(CalibrateDebevecMalik, AGivenSmoothnessIsUsed) {
  const Bracket bracket = simulate(srgb_response(8), {});
  EXPECT_EQ(calibrate_debevec_malik(bracket, {}, {.smoothness = 0.5}).smoothness, 0.5);
}

// Shutters that are off by several percent, named by the labels of their dial. Mean and slope of the logs of the times
// are no picture's to tell; what is left of the errors is found within 1 %, and the curve with it.
TEST(CalibrateDebevecMalik, RefinesTimes) {
  const double labels[] = {1.0 / 4000, 1.0 / 1000, 1.0 / 400, 1.0 / 125, 1.0 / 30, 1.0 / 10, 1.0 / 4, 1.0};
  const double true_seconds[] = {1.05 * 0x1p-12, 0.97 * 0x1p-10, 1.02 / 400,    0.96 * 0x1p-7,
                                 1.03 * 0x1p-5,  0.99 * 0.1,     1.01 * 0x1p-2, 1.0};
  Simulation simulation;
  simulation.evs.clear();
  for (const double seconds : true_seconds) simulation.evs.push_back(std::log2(seconds) + 6);
  const Response truth = srgb_response(8);
  Bracket bracket = simulate(truth, simulation);
  const auto shots = static_cast<Eigen::Index>(bracket.shots.size());
  Eigen::VectorXd known(shots);
  for (Eigen::Index j = 0; j < shots; ++j) {
    bracket.shots[static_cast<std::size_t>(j)].exposure.seconds = labels[j];
    known[j] = std::log(true_seconds[j]);
  }
  const Calibration fit = calibrate_debevec_malik(bracket, {}, {.refine_times = true});
  const Calibration plain = calibrate_debevec_malik(bracket);
  const auto ln_seconds = [&](const Calibration& calibration) {
    Eigen::VectorXd ln(shots);
    for (Eigen::Index j = 0; j < shots; ++j) ln[j] = std::log(calibration.seconds[static_cast<std::size_t>(j)]);
    return ln;
  };
  // Of the errors of times against the true ones, which no picture can tell.
  const auto slope = [&](const Eigen::VectorXd& ln) {
    const Eigen::VectorXd x = known.array() - known.mean();
    return x.dot(ln - known) / x.squaredNorm();
  };
  const Eigen::VectorXd refined = ln_seconds(fit);
  const double mean_known = known.mean(), mean_error = (refined - known).mean();
  for (Eigen::Index j = 0; j < shots; ++j) {
    EXPECT_NEAR(refined[j] - known[j] - mean_error, slope(refined) * (known[j] - mean_known), 0.01) << "shot " << j;
  }
  // What such a slope does to the curve is no error of the curve.
  const auto curve_error = [&](const Calibration& calibration) {
    Response reachable = truth;
    for (auto& g : reachable.g) {
      for (double& value : g) value *= 1 + slope(ln_seconds(calibration));
    }
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += rms_error(calibration.response, reachable, c) / 3;
    return sum;
  };
  const double before = curve_error(plain), after = curve_error(fit);
  EXPECT_LT(after, 0.5 * before) << "rms of g without refinement " << before << ", with it " << after;
  EXPECT_LT(fit.rms_log_error, plain.rms_log_error);
}

// Times that were right stay right.
TEST(CalibrateDebevecMalik, RefiningLeavesTrueTimesAlone) {
  const Bracket bracket = simulate(film_response(8), {});
  const Calibration fit = calibrate_debevec_malik(bracket, {}, {.refine_times = true});
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    EXPECT_NEAR(fit.seconds[j] / *bracket.shots[j].exposure.seconds, 1, 0.01) << "shot " << j;
  }
}

// The doubt is of the size of the errors, and grows where no shots share codes.
TEST(CalibrateDebevecMalik, TheDeviationOfTheCurveIsHonest) {
  double squares = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Simulation simulation;
    simulation.seed = seed;
    const Response truth = srgb_response(8);
    const Calibration fit = calibrate_debevec_malik(simulate(truth, simulation));
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_EQ(fit.deviation[c].size(), truth.g[c].size());
      EXPECT_EQ(fit.deviation[c][128], 0) << "g(middle) = 0 by definition";
      for (std::size_t code = 20; code <= 235; ++code) {
        if (code == 128) continue;
        const double z = (fit.response.g[c][code] - truth.g[c][code]) / fit.deviation[c][code];
        squares += z * z;
        ++count;
      }
    }
  }
  const double spread = std::sqrt(squares / count);
  EXPECT_GT(spread, 0.4) << "deviations are too large";
  EXPECT_LT(spread, 2.5) << "deviations are too small";
}

// Any function that repeats itself every 2 EV may be added to g and explains the same codes; cameras' curves are known
// well enough to decide. Four film-like curves that are not of Grossberg and Nayar's family by construction.
TEST(CalibrateDebevecMalik, AUniformBracketOfFilmIsSettledByWhatIsKnownOfCameras) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Response truth = film_response(8);
    // Naka-Rushton curves with a toe of another power and another shoulder each time.
    const double power = 0.85 + 0.1 * static_cast<double>(seed), half = 0.1 + 0.04 * static_cast<double>(seed);
    for (auto& g : truth.g) {
      for (std::size_t code = 1; code < 256; ++code) {
        const double value = static_cast<double>(code) / 255;
        g[code] = std::log(half * value / (1 + half - value)) / power;
      }
      g[0] = g[1] - std::log(4.0);
      const double middle = g[128];
      for (double& each : g) each -= middle;
    }
    Simulation simulation;
    simulation.seed = seed;
    simulation.evs = {-6, -4, -2, 0, 2, 4, 6};
    const Calibration fit = calibrate_debevec_malik(simulate(truth, simulation));
    for (int c = 0; c < 3; ++c) EXPECT_LT(rms_error(fit.response, truth, c), 0.03) << "seed " << seed;
    // What the last code means is the bound of every sun.
    EXPECT_NEAR(fit.response.g[1][255], truth.g[1][255], 0.05) << "seed " << seed;
  }
}

TEST(CalibrateDebevecMalik, UniformLargeStepsAreAWarning) {
  Simulation simulation;
  simulation.evs = {-4, -2, 0, 2, 4};
  const auto warned = [&] {
    for (const std::string& w : calibrate_debevec_malik(simulate(srgb_response(8), simulation), {}, kQuick).warnings) {
      if (w.find("off the grid") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(warned());
  simulation.evs.push_back(0.67);
  std::sort(simulation.evs.begin(), simulation.evs.end());
  EXPECT_FALSE(warned()) << "a shot between settles it";
  simulation.evs = {-3, -2, -1, 0, 1, 2};
  EXPECT_FALSE(warned()) << "smoothness settles waves of 1 EV";
}

TEST(CalibrateDebevecMalik, FollowsTheRegistration) {
  Simulation simulation;
  std::vector<Mat3> ref_from_photo(simulation.evs.size(), Mat3::Identity());
  for (std::size_t j = 0; j < ref_from_photo.size(); ++j) {
    ref_from_photo[j](0, 2) = 9.0 * (static_cast<double>(j % 3) - 1);
    ref_from_photo[j](1, 2) = 5.0 * (static_cast<double>(j % 2));
  }
  const Response truth = film_response(8);
  const Bracket bracket = simulate(truth, simulation, ref_from_photo);
  EXPECT_LT(rms_error(calibrate_debevec_malik(bracket, ref_from_photo, kQuick).response, truth, 1), 0.02);
}

// Something bright walks through each shot in another place.
TEST(CalibrateDebevecMalik, IsNotMovedByWhatMoves) {
  const Response truth = film_response(8);
  Bracket bracket = simulate(truth, {});
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    auto& codes = std::get<Image<std::uint8_t>>(bracket.shots[j].codes);
    for (int y = 100; y < 250; ++y) std::fill_n(codes.pixel(45 * static_cast<int>(j), y), 3 * 22, std::uint8_t{140});
  }
  const Response fit = calibrate_debevec_malik(bracket).response;
  EXPECT_LT(rms_error(fit, truth, 1), 0.01);
  EXPECT_EQ(fit.black_code(1), 0) << "no black level is invented";
}

TEST(CalibrateDebevecMalik, AChannelClippedEverywhereBorrowsTheOthersCurve) {
  Bracket bracket = simulate(srgb_response(8), {});
  for (Photo& photo : bracket.shots) {
    auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
    for (int y = 0; y < codes.height(); ++y) {
      for (int x = 0; x < codes.width(); ++x) codes(x, y, 2) = 255;
    }
  }
  const Calibration fit = calibrate_debevec_malik(bracket, {}, kQuick);
  ASSERT_FALSE(fit.warnings.empty());
  EXPECT_NE(fit.warnings[0].find("blue"), std::string::npos) << fit.warnings[0];
  EXPECT_NEAR(fit.response.g[2][200], 0.5 * (fit.response.g[0][200] + fit.response.g[1][200]), 1e-12);
}

// A scan of film never writes code 0: here 16 is black, and it is found.
TEST(CalibrateDebevecMalik, FindsABlackLevel) {
  const Response truth = gamma_response(8, 2.0);
  Bracket bracket = simulate(truth, {});
  for (Photo& photo : bracket.shots) {
    auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
    for (int y = 0; y < codes.height(); ++y) {
      for (int k = 0; k < 3 * codes.width(); ++k) {
        codes.row(y)[k] = static_cast<std::uint8_t>(std::lround(16 + codes.row(y)[k] * 239.0 / 255));
      }
    }
  }
  const Response fit = calibrate_debevec_malik(bracket, {}, kQuick).response;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(fit.black_code(c), 19, 3) << "channel " << c;
  const double stops = (fit.g[1][220] - fit.g[1][60]) / std::log(2.0);
  EXPECT_NEAR(stops, 2.0 * std::log2(204.0 / 44.0), 0.1) << "above the pedestal the curve is the camera's";
}

TEST(CalibrateDebevecMalik, HopelessBracketsAreErrorsThatNameAFileAndARemedy) {
  const auto message = [](const Bracket& bracket) -> std::string {
    try {
      calibrate_debevec_malik(bracket);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  Simulation simulation;
  simulation.evs = {0};
  EXPECT_NE(message(simulate(srgb_response(8), simulation)).find("shot0.png: one shot"), std::string::npos);
  simulation.evs = {0, 0, 0};
  EXPECT_NE(message(simulate(srgb_response(8), simulation)).find("exposures are equal"), std::string::npos);
  simulation.evs = {-30, -28, -26};
  EXPECT_NE(message(simulate(srgb_response(8), simulation)).find("too few pixels"), std::string::npos) << "all black";
  simulation.evs = {26, 28, 30};
  EXPECT_NE(message(simulate(srgb_response(8), simulation)).find("too few pixels"), std::string::npos) << "all white";
  simulation.evs = {-2, 0, 2};
  simulation.width = simulation.height = 2;
  EXPECT_NE(message(simulate(srgb_response(8), simulation)).find("too few pixels"), std::string::npos) << "2x2";
  Bracket reversed = simulate(srgb_response(8), {});
  for (std::size_t j = 0; j < reversed.shots.size(); ++j)
    reversed.shots[j].exposure.seconds = std::exp2(-2.0 * static_cast<double>(j));
  EXPECT_NE(message(reversed).find("not brighter"), std::string::npos) << message(reversed);
  EXPECT_NE(message(Bracket{}).find("no shots"), std::string::npos);
}

TEST(CalibrateDebevecMalik, ExtrapolatedCodesAreAWarning) {
  Simulation simulation;
  simulation.scene_stops = 0;
  simulation.evs = {-1.5, -0.5};
  Bracket dim = simulate(srgb_response(8), simulation);
  for (Photo& photo : dim.shots) {
    auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
    for (int y = 0; y < codes.height(); ++y) {
      for (int k = 0; k < 3 * codes.width(); ++k) codes.row(y)[k] = std::min<std::uint8_t>(codes.row(y)[k], 120);
    }
  }
  const Calibration fit = calibrate_debevec_malik(dim, {}, kQuick);
  ASSERT_EQ(fit.warnings.size(), 3u);
  EXPECT_NE(fit.warnings[0].find("extrapolated"), std::string::npos);
}

// Histograms do not care where a pixel went.
TEST(ProvisionalResponse, SurvivesShiftsOfTensOfPixels) {
  for (const char* name : {"film", "srgb"}) {
    const Response truth = *response_from_name(name, 8);
    Simulation simulation;
    std::vector<Mat3> shifts(simulation.evs.size(), Mat3::Identity());
    for (std::size_t j = 0; j < shifts.size(); ++j) {
      shifts[j](0, 2) = 25 * std::cos(2.4 * static_cast<double>(j));
      shifts[j](1, 2) = 25 * std::sin(2.4 * static_cast<double>(j));
    }
    const Response fit = provisional_response(simulate(truth, simulation, shifts));
    for (int c = 0; c < 3; ++c) EXPECT_LT(rms_error(fit, truth, c), 0.12) << name << ", channel " << c;
  }
}

TEST(ProvisionalResponse, DeepPhotographs) {
  const Response truth = srgb_response(16);
  EXPECT_LT(rms_error(provisional_response(simulate(truth, {})), truth, 1), 0.06);
}

}  // namespace
}  // namespace hdr
