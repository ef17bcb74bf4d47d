#include "libhdr/probe/find_ball.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/photograph.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

void add_noise(Image<float>& picture, double share, std::uint64_t seed) {
  for (int y = 0; y < picture.height(); ++y) {
    Random random(seed, static_cast<std::uint64_t>(y));
    for (std::size_t k = 0; k < picture.row_samples(); ++k) {
      float& value = picture.row(y)[k];
      value *= static_cast<float>(std::max(0.0, 1 + share * random.normal()));
    }
  }
}

struct Case {
  std::uint64_t seed;
  MirrorBall ball;
  double fov, noise;
};

class FindBall : public testing::TestWithParam<Case> {};

// A mirror has no colour of its own: rooms with texture are what there is to go by.
TEST_P(FindBall, PlacesTheOutlineWithinAPixel) {
  const Case& c = GetParam();
  const Image<float> scene = test::latlong_of(512, test::SoftRoom(c.seed, 0.5));
  Image<float> picture =
      photograph_ball(scene, {1000, 750}, c.ball, c.fov, rotation_from_degrees({5, 47.0 * double(c.seed), 0}));
  add_noise(picture, c.noise, c.seed);
  const auto found = find_ball(picture);
  ASSERT_TRUE(found);
  EXPECT_LT(std::hypot(found->ball.disc.cx - c.ball.disc.cx, found->ball.disc.cy - c.ball.disc.cy), 0.6);
  EXPECT_NEAR(found->ball.disc.r, c.ball.disc.r, 0.6);
  EXPECT_GT(found->support, 0.6);
  EXPECT_LT(found->residual_px, 1.5);
}

INSTANTIATE_TEST_SUITE_P(Rooms, FindBall,
                         testing::Values(Case{1, {{431.3, 377.8, 352}, kFar}, 35, 0.002},
                                         Case{2, {{640.7, 250.1, 120}, 12}, 35, 0.005},
                                         Case{3, {{254.4, 511.6, 231}, kFar}, 50, 0.01},
                                         Case{4, {{512.9, 333.2, 300}, 5}, 35, 0.005}));

TEST(FindBallInNothing, ARoomWithoutABallHasNone) {
  for (const std::uint64_t seed : {11u, 12u, 13u}) {
    const Image<float> scene = test::latlong_of(512, test::SoftRoom(seed, 0.5));
    Image<float> view = photograph_view(scene, {800, 600}, 50, rotation_from_degrees({0, 31.0 * double(seed), 0}));
    add_noise(view, 0.01, seed);
    EXPECT_FALSE(find_ball(view)) << "in view " << seed;
    EXPECT_FALSE(find_ball(scene)) << "in lat-long " << seed;
  }
}

TEST(FindBallInNothing, FlatBlackNoisyOrTinyPicturesHaveNone) {
  Image<float> flat(300, 200, 3);
  EXPECT_FALSE(find_ball(flat)) << "black";
  for (int y = 0; y < 200; ++y) std::fill_n(flat.row(y), 900, 0.5f);
  EXPECT_FALSE(find_ball(flat)) << "flat";
  add_noise(flat, 0.3, 5);
  EXPECT_FALSE(find_ball(flat)) << "noise";
  EXPECT_FALSE(find_ball(Image<float>(1, 1, 3)));
  EXPECT_FALSE(find_ball(Image<float>(5000, 33, 3))) << "a strip";
  std::fill_n(flat.row(70), 300, std::numeric_limits<float>::quiet_NaN());
  std::fill_n(flat.row(90), 300, std::numeric_limits<float>::infinity());
  EXPECT_FALSE(find_ball(flat)) << "NaN and infinity";
  EXPECT_FALSE(find_ball(Image<float>()));
}

/// As an enlarged, compressed snapshot: each pixel the mean of a wide square, several times over.
Image<float> blurred(const Image<float>& picture, int radius) {
  Image<float> result(picture.size(), 3);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        int count = 0;
        for (int v = std::max(0, y - radius); v <= std::min(picture.height() - 1, y + radius); ++v) {
          for (int u = std::max(0, x - radius); u <= std::min(picture.width() - 1, x + radius); ++u, ++count)
            sum += static_cast<double>(picture(u, v, c));
        }
        result(x, y, c) = static_cast<float>(sum / count);
      }
    }
  }
  return result;
}

TEST(FindBallInBlur, ABallThatFillsItsFrameIsFoundByItsEdge) {
  int found = 0;
  for (const std::uint64_t seed : {51u, 52u, 53u, 54u}) {
    const MirrorBall ball{{243, 231, 205 + 5.0 * double(seed - 51)}};
    const Image<float> scene = test::latlong_of(512, test::SoftRoom(seed, 0.5));
    Image<float> sharp = photograph_ball(scene, {480, 464}, ball);
    for (int y = 0; y < 464; ++y) {
      for (int x = 0; x < 480; ++x) {
        if (!ball.dir_from_px({x + 0.5, y + 0.5})) continue;
        for (int c = 0; c < 3; ++c) sharp(x, y, c) *= 0.5f;  // tarnished
      }
    }
    Image<float> picture = blurred(blurred(sharp, 3), 3);
    add_noise(picture, 0.02, seed);
    const auto place = find_ball(picture);
    if (!place) continue;
    ++found;
    EXPECT_NEAR(place->ball.disc.cx, 243, 12) << "seed " << seed;
    EXPECT_NEAR(place->ball.disc.cy, 231, 12) << "seed " << seed;
    EXPECT_NEAR(place->ball.disc.r, ball.disc.r, 12) << "seed " << seed;
  }
  EXPECT_GE(found, 3) << "of four; a rim that blends with its backdrop may hide one";
}

}  // namespace
}  // namespace hdr
