#include "libhdr/probe/photograph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/unwrap.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double log2_error(double a, double b) {
  return std::abs(std::log2(a / b));
}

TEST(PhotographView, LooksWhereItIsTurned) {
  const test::SoftRoom room(31);
  const Image<float> scene = test::latlong_of(512, room);
  const Mat3 turn = rotation_from_degrees({10, 80, 0});
  const Image<float> view = photograph_view(scene, {160, 120}, 60, turn);
  const Rectilinear camera{{160, 120}, 60};
  for (int y = 5; y < 120; y += 20) {
    for (int x = 5; x < 160; x += 20) {
      const Vec3 d = turn * *camera.dir_from_px({x + 0.5, y + 0.5});
      EXPECT_LT(log2_error(view(x, y, 2), room(d, 2)), 0.01);
    }
  }
}

TEST(PhotographBall, MiddleShowsThePhotographerAndRightShowsRight) {
  const Image<float> scene = test::latlong_of(512, [](const Vec3& d, int c) { return std::exp(3 * d[c]); });
  const MirrorBall ball{{160, 110, 80}};
  const Image<float> picture = photograph_ball(scene, {300, 220}, ball);
  EXPECT_NEAR(picture(160, 110, 2), std::exp(3.0), 0.1);                                          // +Z
  EXPECT_NEAR(picture(static_cast<int>(160 + 80 * std::sqrt(0.5)), 110, 0), std::exp(3.0), 0.1);  // +X
  EXPECT_NEAR(picture(160, static_cast<int>(110 - 80 * std::sqrt(0.5)), 1), std::exp(3.0), 0.1);  // +Y
  EXPECT_NEAR(picture(299, 110, 2), std::exp(-3.0), 0.05) << "the backdrop is around -Z";
  EXPECT_GT(picture(299, 110, 0), picture(5, 110, 0)) << "in the backdrop, too, right is +X";
  EXPECT_GT(picture(160, 5, 1), picture(160, 215, 1)) << "and up is +Y";
}

// A ray that grazes the ball goes on as it came: at a finite distance rim and backdrop meet.
TEST(PhotographBall, RimAndBackdropMeetAtAFiniteDistance) {
  const test::SoftRoom room(8);
  const Image<float> scene = test::latlong_of(512, room);
  for (const double distance : {3.0, 12.0}) {
    const MirrorBall ball{{200, 150, 110}, distance};
    const Image<float> picture = photograph_ball(scene, {400, 300}, ball);
    for (double angle = 0; angle < 6.28; angle += 0.1) {
      const int x = static_cast<int>(200 + 112 * std::cos(angle)), y = static_cast<int>(150 - 112 * std::sin(angle));
      const double out = std::asin(1 / distance);
      const Vec3 rim(std::sin(out) * std::cos(angle), std::sin(out) * std::sin(angle), -std::cos(out));
      EXPECT_LT(log2_error(picture(x, y, 1), room(rim, 1)), 0.1) << "D = " << distance << " at angle " << angle;
    }
  }
}

TEST(PhotographBall, AConstantSceneIsConstantToTheRim) {
  Image<float> scene(64, 32, 3);
  for (int y = 0; y < 32; ++y) std::fill_n(scene.row(y), 64 * 3, 0.25f);
  const Image<float> picture = photograph_ball(scene, {90, 70}, {{45.2, 33.3, 30}, 9});
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 90 * 3; ++x) ASSERT_NEAR(picture.row(y)[x], 0.25f, 1e-6f);
  }
}

// The rim pixels against brute force: 64 x 64 rays a pixel.
TEST(PhotographBall, RimPixelsAreTheMeanOfTheirArea) {
  const test::SoftRoom room(77, 0.3);
  const Image<float> scene = test::latlong_of(1024, room);
  const MirrorBall ball{{60.4, 50.7, 45}};
  const Size size{120, 100};
  const Image<float> picture = photograph_ball(scene, size, ball, 20);
  // The same camera's backdrop alone: the ball behind a pinhole with the disc's centre on its axis.
  const double focal = 60 / std::tan(10 * kDegree);
  for (int x = 100; x < 110; ++x) {
    const int y = 58;
    double expected = 0;
    constexpr int kSide = 64;
    for (int k = 0; k < kSide * kSide; ++k) {
      const Vec2 px(x + (k % kSide + 0.5) / kSide, y + (k / kSide + 0.5) / kSide);
      const Vec3 ray = Vec3((px.x() - 60.4) / focal, -(px.y() - 50.7) / focal, -1).normalized();
      expected += room(ball.dir_from_px(px).value_or(ray), 1) / (kSide * kSide);
    }
    EXPECT_NEAR(picture(x, y, 1) / expected, 1, 0.02) << "pixel " << x;
  }
}

TEST(PhotographBall, ACameraInsideTheBallIsAnError) {
  Image<float> scene(64, 32, 3);
  EXPECT_THROW(photograph_ball(scene, {90, 70}, {{45, 33, 30}, 1.0}), Error);
  EXPECT_THROW(photograph_ball(scene, {90, 70}, {{45, 33, 30}}, 200), Error);
}

// The main law: scene -> photograph of the ball -> unwrapped probe = scene, away from the blind spot and the camera.
class BallToProbe : public testing::TestWithParam<double> {};

TEST_P(BallToProbe, GivesTheSceneBack) {
  const test::SoftRoom room(15, 0.3);
  const Image<float> scene = test::latlong_of(512, room);
  const MirrorBall ball{{371.3, 296.8, 260}, GetParam()};
  const Mat3 turn = rotation_from_degrees({8, 140, -3});
  const Image<float> picture = photograph_ball(scene, {750, 600}, ball, 35, turn);
  const Image<float> probe = resample(picture, ball, LatLong{{256, 128}}, {256, 128});
  std::vector<double> errors;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / 256, (y + 0.5) / 128);
      if (std::abs(d.z()) > std::cos(15 * kDegree)) continue;
      for (int c = 0; c < 3; ++c) errors.push_back(log2_error(probe(x, y, c), room(turn * d, c)));
    }
  }
  std::sort(errors.begin(), errors.end());
  const double median = errors[errors.size() / 2], p99 = errors[errors.size() * 99 / 100];
  RecordProperty("median", std::to_string(median));
  RecordProperty("p99", std::to_string(p99));
  // Measured: medians near 0.01. The rest is the texture near the blind spot, where the ball shows little of it.
  EXPECT_LT(median, 0.03);
  EXPECT_LT(p99, 0.35);
}

INSTANTIATE_TEST_SUITE_P(Distances, BallToProbe, testing::Values(kFar, 20.0, 5.0));

}  // namespace
}  // namespace hdr
