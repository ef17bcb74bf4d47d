// Registration against motion that is known exactly (simulated_bracket.h).
#include "libhdr/align/align.h"

#include <gtest/gtest.h>

#include <algorithm>

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
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LE(error_px(made, found, k), 0.1) << "shot " << k;
}

TEST(Align, ASmallRotationLeavesTheBestTranslation) {
  const Image<float> scene = test_scene(320, 240, 8, 91);
  Sensor sensor;
  sensor.response = srgb_response(8);
  sensor.sensitivity = 0.18;
  Bracket bracket;
  std::vector<Vec2> centre_moves;
  const Vec2 centre(159.5, 119.5);
  for (int k = 0; k < 3; ++k) {
    // 0.2 degrees about the centre, and a shift: the centre itself only shifts.
    const Vec2 shift(3.25 * (k - 1), -2.5 * (k - 1));
    Eigen::Affine2d motion =
        Eigen::Translation2d(centre + shift) * Eigen::Rotation2Dd(0.0035 * (k - 1)) * Eigen::Translation2d(-centre);
    Exposure exposure;
    exposure.seconds = std::exp2(2 * (k - 1));
    bracket.shots.push_back(expose(shake(scene, motion.matrix()), exposure, sensor, static_cast<std::uint64_t>(k)));
    centre_moves.push_back(shift);
  }
  const Alignment found = align(bracket, sensor.response);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 truth = centre_moves[k] - centre_moves[static_cast<std::size_t>(found.reference)];
    const Vec2 measured = found.frames[k].ref_from_photo.topRightCorner<2, 1>();
    // The corners turn by 0.7 px; where the content lies within the picture decides which translation is best.
    EXPECT_LE((measured - truth).norm(), 0.7) << "shot " << k << " " << found.frames[k].skipped;
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
