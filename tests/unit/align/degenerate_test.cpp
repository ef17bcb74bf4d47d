// What cannot be registered: it is said, it is not moved far, and it does not mislead the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "libhdr/align/align.h"
#include "tests/support/rounds.h"
#include "tests/unit/align/simulated_bracket.h"

namespace hdr::test {
namespace {

using Scene = std::function<double(double x, double y)>;  // radiance at a point, pixels

Image<float> picture_of(const Scene& scene, Size size, const Vec2& shift) {
  constexpr int kSide = 4;  // samples of a pixel
  Image<float> picture(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      double sum = 0;
      for (int k = 0; k < kSide * kSide; ++k) {
        sum += scene(x + shift.x() + (k % kSide + 0.5) / kSide, y + shift.y() + (k / kSide + 0.5) / kSide);
      }
      for (int c = 0; c < 3; ++c) picture(x, y, c) = static_cast<float>(sum / (kSide * kSide));
    }
  }
  return picture;
}

Photo photograph(View<const float> picture, double seconds, std::uint64_t seed) {
  Sensor sensor;
  sensor.response = srgb_response(8);
  sensor.sensitivity = 0.18;
  Exposure exposure;
  exposure.seconds = seconds;
  return expose(picture, exposure, sensor, seed);
}

/// Three shots two stops apart; shot k shows `scene` from k * shift on.
Bracket bracket_of(const Scene& scene, Size size, const Vec2& shift) {
  Bracket bracket;
  for (int k = 0; k < 3; ++k) {
    const Image<float> picture = picture_of(scene, size, k * shift);
    bracket.shots.push_back(photograph(picture, std::exp2(2 * k - 2), static_cast<std::uint64_t>(k) + 7));
  }
  return bracket;
}

/// Each shot that is not said to be unmeasured lies where the truth is; each but the reference has an error.
void expect_stated_or_right(const Alignment& found, const Vec2& shift, double tolerance) {
  ASSERT_EQ(found.frames.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const FrameAlignment& frame = found.frames[static_cast<std::size_t>(k)];
    if (k == found.reference) continue;
    EXPECT_GT(frame.residual_px, 0) << "shot " << k << ": nothing is known without error";
    const Vec2 moved = frame.ref_from_photo.topRightCorner<2, 1>();
    const bool measured = frame.skipped.empty() || frame.skipped.starts_with("registered already");
    if (measured) {
      EXPECT_LE((moved - (k - found.reference) * shift).norm(), tolerance) << "shot " << k << ", silently";
    } else {
      EXPECT_LE(moved.norm(), 2.5 * shift.norm() + 0.1) << "shot " << k << " flew off: " << frame.skipped;
    }
  }
}

constexpr Size kSize{320, 240};
constexpr double kPi = 3.14159265358979;

TEST(Degenerate, AWallWithoutTexture) {
  const Alignment found = align(bracket_of([](double, double) { return 1.0; }, kSize, {4, 2}), srgb_response(8));
  EXPECT_TRUE(found.identity());
  for (std::size_t k = 0; k < 3; ++k) {
    if (static_cast<int>(k) == found.reference) continue;
    EXPECT_TRUE(found.frames[k].skipped.starts_with("not measured")) << found.frames[k].skipped;
    EXPECT_GT(found.frames[k].residual_px, 0.5) << "who has measured nothing has not measured well";
    EXPECT_EQ(found.frames[k].inliers, 0);
  }
}

TEST(Degenerate, StripesTellOneDirectionAtMost) {
  for (const double period : {8.0, 24.0}) {
    const Scene stripes = [&](double x, double) { return 1 + 0.5 * std::sin(2 * kPi * x / period); };
    for (const Vec2& shift : {Vec2(2, 3), Vec2(9, 0), Vec2(0, 7)}) {
      const Alignment found = align(bracket_of(stripes, kSize, shift), srgb_response(8));
      expect_stated_or_right(found, shift, 0.5);
    }
  }
}

TEST(Degenerate, ACheckerboardRepeats) {
  for (const double period : {8.0, 24.0, 40.0}) {
    const Scene board = [&](double x, double y) {
      return std::sin(2 * kPi * x / period) * std::sin(2 * kPi * y / period) > 0 ? 1.6 : 0.4;
    };
    for (const Vec2& shift : {Vec2(1.5, 1), Vec2(7, 5), Vec2(14, 11)}) {
      SCOPED_TRACE(testing::Message() << "period " << period << " shift " << shift.transpose());
      const Alignment found = align(bracket_of(board, kSize, shift), srgb_response(8));
      expect_stated_or_right(found, shift, 0.5);
    }
  }
}

/// Three shots of a scene at the same place, the middle one replaced.
Bracket with_stranger(const Image<float>& stranger, std::uint64_t seed) {
  const Image<float> scene = test_scene(kSize.width, kSize.height, 8, seed);
  Bracket bracket;
  for (int k = 0; k < 3; ++k) {
    const View<const float> shown = k == 2 ? stranger.view() : scene.view();
    bracket.shots.push_back(photograph(shown, std::exp2(k - 1), seed + static_cast<std::uint64_t>(k)));
  }
  return bracket;
}

/// The stranger is named and far from sure; the others lie where they lay.
void expect_left_out(const Alignment& found) {
  const FrameAlignment& stranger = found.frames[2];
  ASSERT_NE(found.reference, 2);
  EXPECT_FALSE(stranger.skipped.empty());
  EXPECT_GT(stranger.residual_px, 1) << "the merge leaves out what is registered within a pixel only: "
                                     << stranger.skipped;
  EXPECT_LT(stranger.inliers, 0.5);
  EXPECT_LE(stranger.ref_from_photo.topRightCorner(2, 1).norm(), 1) << stranger.skipped;
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(found.frames[k].ref_from_photo, Mat3::Identity().eval()) << "shot " << k;
    EXPECT_LT(found.frames[k].residual_px, 0.1) << "shot " << k;
  }
}

TEST(Degenerate, AnotherScene) {
  for (std::uint64_t seed = 1; seed < 1 + test::rounds(5); ++seed) {
    SCOPED_TRACE(seed);
    const Image<float> other = test_scene(kSize.width, kSize.height, 8, seed + 100);
    expect_left_out(align(with_stranger(other, seed), srgb_response(8)));
  }
}

TEST(Degenerate, NoOverlap) {
  const Image<float> wide = test_scene(2 * kSize.width, kSize.height, 8, 3);
  Image<float> beside(kSize, 3);
  for (int y = 0; y < kSize.height; ++y) std::copy_n(wide.pixel(kSize.width, y), 3 * kSize.width, beside.row(y));
  expect_left_out(align(with_stranger(beside, 3), srgb_response(8)));
}

TEST(Degenerate, AShotTurnedByNinetyDegrees) {
  const Image<float> scene = test_scene(kSize.width, kSize.height, 8, 4);
  Image<float> turned(kSize, 3);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const int u = std::clamp(kSize.width / 2 + y - kSize.height / 2, 0, kSize.width - 1);
      const int v = std::clamp(kSize.height / 2 - (x - kSize.width / 2), 0, kSize.height - 1);
      std::copy_n(scene.pixel(u, v), 3, turned.pixel(x, y));
    }
  }
  expect_left_out(align(with_stranger(turned, 4), srgb_response(8)));
}

TEST(Degenerate, BlackAndWhiteHaveNoUsablePixels) {
  for (const double light : {0.0, 1e6}) {
    const Alignment found = align(bracket_of([&](double, double) { return light; }, kSize, {1, 0}), srgb_response(8));
    EXPECT_TRUE(found.identity());
    ASSERT_EQ(found.frames.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(found.frames[k].skipped, "no usable pixels");
      EXPECT_GT(found.frames[k].residual_px, 0) << "an unmeasured shot does not claim to be exact";
    }
  }
}

TEST(Degenerate, SixteenPixelsASide) {
  for (std::uint64_t seed = 1; seed < 1 + test::rounds(8); ++seed) {
    SCOPED_TRACE(seed);
    SimulationOptions options;
    options.size = {16, 16};
    options.shots = 3;
    options.scene_stops = 4;
    options.largest_shift = 1;
    const SimulatedBracket made = simulate(options, seed);
    const Alignment found = align(made.bracket, srgb_response(8));
    for (std::size_t k = 0; k < 3; ++k) {
      const bool measured = found.frames[k].skipped.empty();
      EXPECT_LE(error_px(made, found, k), measured ? 0.5 : 4.0) << "shot " << k << " " << found.frames[k].skipped;
    }
  }
}

// A line of pixels has no inside to compare.
TEST(Degenerate, ColumnsRowsAndSinglePixels) {
  const Scene waves = [](double x, double y) { return 1 + 0.5 * std::sin(0.7 * x + 0.4 * y); };
  for (const Size size : {Size{1, 1}, {1, 40}, {40, 1}, {2, 33}, {3, 3}}) {
    for (const AlignMethod method :
         {AlignMethod::kAuto, AlignMethod::kMtb, AlignMethod::kEcc, AlignMethod::kFeatures}) {
      SCOPED_TRACE(std::to_string(size.width) + "x" + std::to_string(size.height));
      const Alignment found = align(bracket_of(waves, size, Vec2::Zero()), srgb_response(8), method);
      for (const FrameAlignment& frame : found.frames) {
        EXPECT_TRUE(frame.ref_from_photo.allFinite());
        if (method != AlignMethod::kAuto) continue;
        EXPECT_LE(Vec2(frame.ref_from_photo.topRightCorner<2, 1>()).norm(), 0.5) << "shots of a scene at rest";
      }
    }
  }
}

}  // namespace
}  // namespace hdr::test
