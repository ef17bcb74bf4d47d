// Registration against motion that is known exactly (simulated_bracket.h).
#include "libhdr/align/align.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "libhdr/core/parallel.h"
#include "tests/unit/align/simulated_bracket.h"

namespace hdr::test {
namespace {

constexpr double kSeen = 0.02;  // share of usable pixels from which a shot must be registered

/// Every shot that shows enough lies within `tolerance` of the truth.
void expect_registered(const SimulatedBracket& made, const Alignment& found, double tolerance) {
  ASSERT_EQ(found.frames.size(), made.bracket.shots.size()) << "every shot keeps its row";
  for (std::size_t k = 0; k < found.frames.size(); ++k) {
    const double share = usable_share(made.bracket.shots[k]);
    if (share < kSeen) {
      EXPECT_EQ(found.frames[k].skipped, "no usable pixels") << "shot " << k << ", usable " << share;
      continue;
    }
    EXPECT_LE(error_px(made, found, k), tolerance)
        << "shot " << k << ", usable " << share << ", reference " << found.reference << ", own estimate "
        << found.frames[k].residual_px << " px, skipped '" << found.frames[k].skipped << "'";
  }
}

class RandomBracket : public testing::TestWithParam<int> {};

TEST_P(RandomBracket, IsRegisteredToATenthOfAPixel) {
  SimulationOptions options;
  options.shots = GetParam() % 2 ? 9 : 7;
  options.response = GetParam() % 3 ? "srgb" : "film";
  const SimulatedBracket made = simulate(options, static_cast<std::uint64_t>(GetParam()));
  expect_registered(made, align(made.bracket, *response_from_name(options.response, 8)), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomBracket, testing::Range(1, 5));

TEST(Align, AWrongResponseDoesNotPullIt) {
  SimulationOptions options;
  options.shots = 7;
  options.response = "film";
  const SimulatedBracket made = simulate(options, 21);
  expect_registered(made, align(made.bracket, gamma_response(8, 2.2)), 0.1);
}

TEST(Align, TheResidualIsOfTheOrderOfTheTrueError) {
  int shots = 0, honest = 0;
  double ratio_squares = 0;
  for (std::uint64_t seed = 31; seed < 36; ++seed) {
    SimulationOptions options;
    options.shots = 7;
    options.size = {240, 180};
    const SimulatedBracket made = simulate(options, seed);
    const Alignment found = align(made.bracket, srgb_response(8));
    for (std::size_t k = 0; k < found.frames.size(); ++k) {
      if (static_cast<int>(k) == found.reference || usable_share(made.bracket.shots[k]) < kSeen) continue;
      ++shots;
      EXPECT_GT(found.frames[k].residual_px, 0) << "no measurement is free of error";
      honest += error_px(made, found, k) < 4 * found.frames[k].residual_px + 0.02;
      ratio_squares += std::pow(error_px(made, found, k) / found.frames[k].residual_px, 2);
    }
  }
  EXPECT_GE(honest, 0.95 * shots) << honest << " of " << shots << " within 4 residuals + 0.02 px";
  EXPECT_GT(std::sqrt(ratio_squares / shots), 0.2) << "a residual five times the error would be no estimate either";
}

TEST(Align, ShotsThatLieStillKeepTheIdentityExactlyAndSaySo) {
  for (const Size size : {Size{400, 300}, Size{257, 211}}) {
    SimulationOptions options;
    options.size = size;
    options.shots = 5;
    options.largest_shift = 0;
    const SimulatedBracket made = simulate(options, 41);
    const Alignment found = align(made.bracket, srgb_response(8));
    EXPECT_TRUE(found.identity()) << "resampling would blur for nothing";
    for (const FrameAlignment& frame : found.frames) {
      EXPECT_FALSE(frame.skipped.empty());
      EXPECT_LT(frame.residual_px, 0.1) << frame.skipped;
    }
    const std::size_t neighbour = static_cast<std::size_t>(found.reference + 1);
    EXPECT_EQ(found.frames[neighbour].skipped.rfind("registered already, within 0.", 0), 0u)
        << found.frames[neighbour].skipped;
  }
}

TEST(Align, AnyNumberOfThreadsGivesTheSameBits) {
  SimulationOptions options;
  options.shots = 3;
  const SimulatedBracket made = simulate(options, 51);
  set_threads(1);
  const Alignment one = align(made.bracket, srgb_response(8));
  set_threads(4);
  const Alignment four = align(made.bracket, srgb_response(8));
  set_threads(0);
  for (std::size_t k = 0; k < one.frames.size(); ++k) {
    EXPECT_EQ(one.frames[k].ref_from_photo, four.frames[k].ref_from_photo) << "shot " << k;
    EXPECT_EQ(one.frames[k].residual_px, four.frames[k].residual_px) << "shot " << k;
  }
}

TEST(Align, EveryMethodIsReal) {
  SimulationOptions options;
  options.shots = 5;
  const SimulatedBracket made = simulate(options, 61);
  const Response response = srgb_response(8);
  expect_registered(made, align(made.bracket, response, AlignMethod::kEcc), 0.5);
  expect_registered(made, align(made.bracket, response, AlignMethod::kFeatures), 0.5);
  // Whole pixels for each pair, and the truth lies on quarters: half a pixel an axis and pair, four pairs at most.
  expect_registered(made, align(made.bracket, response, AlignMethod::kMtb), 2.0);
  EXPECT_TRUE(align(made.bracket, response, AlignMethod::kNone).identity());
}

Photo grey_photo(Size size, int code, double seconds) {
  Photo photo;
  photo.path = "grey.png";
  photo.exposure.seconds = seconds;
  Image<std::uint8_t> codes(size, 3);
  for (int y = 0; y < size.height; ++y) std::fill_n(codes.row(y), 3 * size.width, static_cast<std::uint8_t>(code));
  photo.codes = std::move(codes);
  return photo;
}

TEST(Align, NothingToSeeMeansNothingMoves) {
  const Response response = srgb_response(8);
  for (const AlignMethod method : {AlignMethod::kAuto, AlignMethod::kMtb, AlignMethod::kEcc, AlignMethod::kFeatures}) {
    for (const Size size : {Size{1, 1}, Size{2, 1}, Size{5, 3}, Size{64, 40}, Size{200, 130}}) {
      for (const int code : {0, 128, 255}) {
        Bracket bracket;
        for (int k = 0; k < 3; ++k) bracket.shots.push_back(grey_photo(size, code, std::exp2(k)));
        const Alignment found = align(bracket, response, method);
        EXPECT_TRUE(found.identity()) << size.width << "x" << size.height << " of code " << code;
        ASSERT_EQ(found.frames.size(), 3u);
        EXPECT_EQ(found.frames[0].skipped == "no usable pixels", code != 128) << found.frames[0].skipped;
      }
    }
  }
  EXPECT_TRUE(align({}, response).frames.empty());
}

TEST(Align, TwoIdenticalShotsStay) {
  SimulationOptions options;
  options.size = {120, 90};
  options.shots = 1;
  Bracket bracket;
  for (int k = 0; k < 2; ++k) bracket.shots.push_back(std::move(simulate(options, 71).bracket.shots[0]));
  EXPECT_TRUE(align(bracket, srgb_response(8)).identity());
}

/// Left half dark, right half bright, both with texture: what one shot shows is black or clipped in the other.
Image<float> two_worlds(Size size) {
  Random random(91, 1);
  Image<float> scene(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double light = (x < size.width / 2 ? 1e-4 : 1) * (0.5 + random.uniform());
      for (int c = 0; c < 3; ++c) scene(x, y, c) = static_cast<float>(light);
    }
  }
  return scene;
}

TEST(Align, WhatMeetsOnlyByMovingProvesNothing) {
  for (const Size size : {Size{320, 240}, Size{640, 200}}) {
    const Image<float> scene = two_worlds(size);
    Sensor sensor;
    sensor.response = *response_from_name("linear", 16);
    sensor.noise = {30000, 5};
    sensor.sensitivity = 0.5;
    Bracket bracket;
    for (const double seconds : {1.0, 5e3}) {
      Exposure exposure;
      exposure.seconds = seconds;
      bracket.shots.push_back(expose(scene, exposure, sensor, 7));
    }
    const Alignment found = align(bracket, sensor.response);
    EXPECT_TRUE(found.identity()) << "moved by " << found.frames[0].ref_from_photo.topRightCorner<2, 1>().transpose()
                                  << " and " << found.frames[1].ref_from_photo.topRightCorner<2, 1>().transpose();
  }
}

TEST(Align, MovedContentDoesNotPullIt) {
  SimulationOptions options;
  options.size = {240, 180};
  options.shots = 3;
  const SimulatedBracket made = simulate(options, 81);
  Bracket bracket;
  // A walker: a sixth of the picture, copied from elsewhere in it, at another place in each shot.
  for (std::size_t k = 0; k < 3; ++k) {
    const Photo& photo = made.bracket.shots[k];
    const auto& still = std::get<Image<std::uint8_t>>(photo.codes);
    Image<std::uint8_t> codes = still.clone();
    for (int y = 50; y < 150; ++y) {
      std::copy_n(still.pixel(90, y - 40), 3 * 70, codes.pixel(20 + 35 * static_cast<int>(k), y));
    }
    bracket.shots.push_back({photo.path, photo.exposure, photo.bits, photo.lossy, std::move(codes)});
  }
  const Alignment found = align(bracket, srgb_response(8));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LE(error_px(made, found, k), 0.1) << "shot " << k << " " << found.frames[k].skipped;
  }
}

/// Root mean square over the picture of the distance between the motion found for shot k and the true one.
double rms_error_px(const std::vector<Mat3>& scene_from_photo, const Alignment& found, Size size, std::size_t k) {
  const Mat3 truth = scene_from_photo[static_cast<std::size_t>(found.reference)].inverse() * scene_from_photo[k];
  double squares = 0;
  for (int j = 0; j < 25; ++j) {
    const Vec3 p((j % 5) * (size.width - 1) / 4.0, (j / 5) * (size.height - 1) / 4.0, 1);
    const Vec2 there = (truth * p).hnormalized(), measured = (found.frames[k].ref_from_photo * p).hnormalized();
    squares += (there - measured).squaredNorm();
  }
  return std::sqrt(squares / 25);
}

/// `motions[k]` takes the pixels of shot k to the scene; shots 2 stops apart.
Bracket moved_bracket(const std::vector<Mat3>& motions, Size size, std::uint64_t seed) {
  const Image<float> scene = test_scene(size.width, size.height, 8, seed);
  Sensor sensor;
  sensor.response = srgb_response(8);
  sensor.sensitivity = 0.18;
  Bracket bracket;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    Exposure exposure;
    exposure.seconds = std::exp2(2 * (static_cast<double>(k) - 1));
    bracket.shots.push_back(expose(shake(scene, motions[k]), exposure, sensor, seed + k));
  }
  return bracket;
}

/// A turn of `degrees` about the middle, and a shift: as a hand moves a camera.
Mat3 turned(Size size, double degrees, const Vec2& shift) {
  const Vec2 middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  const Eigen::Affine2d motion = Eigen::Translation2d(middle + shift) *
                                 Eigen::Rotation2Dd(degrees * std::numbers::pi / 180) * Eigen::Translation2d(-middle);
  return motion.matrix();
}

TEST(Align, TurnsAreMeasured) {
  const Size size{320, 240};
  for (const double degrees : {0.2, 2.0}) {
    std::vector<Mat3> motions;
    for (int k = 0; k < 3; ++k) motions.push_back(turned(size, degrees * (k - 1), Vec2(3.25, -2.5) * (k - 1)));
    const Bracket bracket = moved_bracket(motions, size, 91);
    const Alignment found = align(bracket, srgb_response(8));
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(rms_error_px(motions, found, size, k), 0.1)
          << degrees << " degrees, shot " << k << " " << found.frames[k].skipped << "\n"
          << found.frames[k].ref_from_photo;
    }
  }
}

TEST(Align, NamesOfMethods) {
  EXPECT_EQ(align_method_from_name("auto"), AlignMethod::kAuto);
  EXPECT_EQ(align_method_from_name("none"), AlignMethod::kNone);
  EXPECT_EQ(align_method_from_name("mtb"), AlignMethod::kMtb);
  EXPECT_EQ(align_method_from_name("ecc"), AlignMethod::kEcc);
  EXPECT_EQ(align_method_from_name("features"), AlignMethod::kFeatures);
  EXPECT_EQ(align_method_from_name("surf"), std::nullopt);
}

}  // namespace
}  // namespace hdr::test
