#include "libhdr/probe/find_ball.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/rim_stretch.h"
#include "libhdr/probe/photograph.h"
#include "tests/support/round_thing.h"
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

// Suns of maps that were merged by others: a channel may be without bound, or no number.
TEST(FindBallInNumbers, InfinityAndNaNAtTheRimDoNotHideIt) {
  const MirrorBall ball{{640.7, 250.1, 120}, 12};
  Image<float> picture = photograph_ball(test::latlong_of(512, test::SoftRoom(2, 0.5)), {1000, 750}, ball, 35);
  add_noise(picture, 0.005, 2);
  for (int k = 0; k < 36; ++k) {
    const double angle = k * 10 * kDegree;
    const auto x = static_cast<int>(ball.disc.cx + ball.disc.r * std::cos(angle));
    const auto y = static_cast<int>(ball.disc.cy + ball.disc.r * std::sin(angle));
    picture(x, y, k % 2 ? 0 : 2) = k % 3 ? std::numeric_limits<float>::infinity() : NAN;
  }
  const auto found = find_ball(picture);
  ASSERT_TRUE(found);
  EXPECT_LT(std::hypot(found->ball.disc.cx - ball.disc.cx, found->ball.disc.cy - ball.disc.cy), 1);
  EXPECT_NEAR(found->ball.disc.r, ball.disc.r, 1);
}

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

/// A round thing of radiance(x, y) on the unit disc, y down, before a room.
template <class Radiance>
Image<float> round_thing(std::uint64_t seed, const Disc& disc, const Radiance& radiance) {
  const Image<float> scene = test::latlong_of(512, test::SoftRoom(seed, 0.5));
  Image<float> view = photograph_view(scene, {800, 600}, 50, rotation_from_degrees({0, 53.0 * double(seed), 0}));
  test::paint_round(view, disc, radiance);
  add_noise(view, 0.003, seed);
  return view;
}

TEST(FindBallInNothing, OtherRoundThingsAreNoBalls) {
  using Radiance = std::function<double(const Vec2&)>;
  for (const std::uint64_t seed : {61u, 62u}) {
    Random random(seed, 8);
    const Disc disc{250 + 300 * random.uniform(), 230 + 140 * random.uniform(), 90 + 110 * random.uniform()};
    const double a = random.uniform(), phase = 2 * kPi * random.uniform();
    const test::SoftRoom room(seed + 100, 0.5);
    const std::map<std::string, Radiance> things{
        {"even lamp", [&](const Vec2& p) { return 8 * (1 + 0.2 * a * p.x()); }},
        {"milk glass", [](const Vec2& p) { return 2.4 + 5.6 * std::sqrt(1 - std::min(1.0, p.squaredNorm())); }},
        {"plate",
         [&](const Vec2& p) {
           return (1.2 + 0.6 * std::sin((10 + 20 * a) * p.squaredNorm() + phase)) * (1 + 0.3 * a * p.x());
         }},
        {"wheel",
         [&](const Vec2& p) {
           if (p.norm() > 0.8) return 0.1;
           return std::cos(9 * std::atan2(p.y(), p.x()) + phase) > 0.2 ? 1.5 : 0.3;
         }},
        {"flat mirror", [&](const Vec2& p) { return room(Vec3(p.x(), p.y(), 1.5).normalized(), 1); }},
        {"globe", [&](const Vec2& p) {
           const double z = std::sqrt(std::max(0.0, 1 - p.squaredNorm()));
           return (0.3 + z) * room(Vec3(p.x(), p.y(), z), 1);
         }}};
    for (const auto& [name, radiance] : things)
      EXPECT_FALSE(find_ball(round_thing(seed, disc, radiance))) << name << ", seed " << seed;
  }
}

TEST(FindBallInNothing, ALampThatFillsTheFrameIsNoBall) {
  const Disc disc{396, 303, 268};
  const auto lamp = [](const Vec2& p) { return 2.4 + 5.6 * std::sqrt(1 - std::min(1.0, p.squaredNorm())); };
  for (const std::uint64_t seed : {65u, 66u, 67u, 68u})
    EXPECT_FALSE(find_ball(round_thing(seed, disc, lamp))) << "seed " << seed;
}

TEST(RimStretch, ASphereHasItAndADiscHasNot) {
  const Disc disc{300, 250, 180};
  constexpr double kNoise = 1e-3;
  const auto rim_of = [&](const auto& radiance) {
    Image<float> picture(600, 500, 1);
    for (int y = 0; y < 500; ++y) {
      for (int x = 0; x < 600; ++x)
        picture(x, y) = static_cast<float>(radiance(Vec2((x + 0.5 - disc.cx) / disc.r, (y + 0.5 - disc.cy) / disc.r)));
    }
    return internal::rim_stretch(picture, internal::circle_of(disc), kNoise);
  };
  double stretch = 0, spread = 0, painted = 0;
  int taken = 0;
  constexpr int kSeeds = 8;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const test::SoftRoom room(seed, 0.5);
    const auto ball = rim_of([&](const Vec2& p) {
      const auto d = MirrorBall{{0, 0, 1}}.dir_from_px(p);
      return d ? room(*d, 1) : 1.0;
    });
    const auto window = rim_of([&](const Vec2& p) { return room(Vec3(p.x(), p.y(), 2).normalized(), 1); });
    const auto globe = rim_of(
        [&](const Vec2& p) { return room(Vec3(p.x(), p.y(), std::sqrt(std::max(0.0, 1 - p.squaredNorm()))), 1); });
    EXPECT_TRUE(internal::is_mirrored(ball)) << seed;
    EXPECT_FALSE(internal::is_mirrored(window)) << "a window, seed " << seed;
    taken += internal::is_mirrored(globe);
    stretch += ball.stretch / kSeeds;
    spread += ball.spread / kSeeds;
    painted += globe.stretch / kSeeds;
  }
  EXPECT_NEAR(stretch, 1, 0.25) << "scenes have no direction of their own on the whole";
  EXPECT_NEAR(spread, 0.5, 0.2) << "a smooth scene's";
  EXPECT_NEAR(painted, 0.5, 0.15);
  EXPECT_LE(taken, 1) << "of eight globes: a few waves may lie as if they were spread";
  EXPECT_FALSE(internal::is_mirrored(rim_of([](const Vec2& p) { return 2 + std::cos(8 * std::atan2(p.y(), p.x())); })));
  EXPECT_FALSE(internal::is_mirrored(rim_of([](const Vec2& p) { return 2 + std::cos(30 * p.norm()); })));
  EXPECT_EQ(rim_of([](const Vec2&) { return 1.0; }).patterned, 0);
}

// Clouds and shores lie one way: that lengthens what a ball shows in its middle as at its rim, or shortens it.
TEST(RimStretch, AScenesOwnDirectionDoesNotCount) {
  const Disc disc{300, 250, 180};
  const auto rim_of = [&](const auto& radiance) {
    Image<float> picture(600, 500, 1);
    for (int y = 0; y < 500; ++y) {
      for (int x = 0; x < 600; ++x)
        picture(x, y) = static_cast<float>(radiance(Vec2((x + 0.5 - disc.cx) / disc.r, (y + 0.5 - disc.cy) / disc.r)));
    }
    return internal::rim_stretch(picture, internal::circle_of(disc), 1e-3);
  };
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const test::SoftRoom room(seed, 0.5);
    const auto layers = [&](const Vec3& d) {
      return room(Vec3(0.4 * d.x(), d.y(), 0.4 * d.z()), 1) * std::exp(0.3 * std::sin(20 * d.y() + double(seed)));
    };
    const auto ball = rim_of([&](const Vec2& p) {
      const auto d = MirrorBall{{0, 0, 1}}.dir_from_px(p);
      return d ? layers(*d) : 1.0;
    });
    const auto globe = rim_of(
        [&](const Vec2& p) { return layers(Vec3(p.x(), p.y(), std::sqrt(std::max(0.0, 1 - p.squaredNorm())))); });
    EXPECT_TRUE(is_mirrored(ball)) << "seed " << seed;
    EXPECT_FALSE(is_mirrored(globe)) << "seed " << seed;
    EXPECT_NEAR(ball.mirrored_by_rise(), 1.55, 0.15) << "seed " << seed << ", by stretch " << ball.mirrored();
    EXPECT_LT(globe.mirrored_by_rise(), 0.7) << "seed " << seed;
  }
  // A ball under a night sky and the painted globe that comes nearest to it.
  EXPECT_TRUE(internal::is_mirrored({.stretch = 0.46, .in_middle = -0.52, .spread = 0.23, .patterned = 0.99}));
  // One in a hall of coarse blocks, which was refused, and a plate.
  EXPECT_TRUE(internal::is_mirrored({.stretch = 1.46, .in_middle = 0.63, .spread = -0.37, .patterned = 0.93}));
  // One between tall facades; a sign.
  EXPECT_TRUE(internal::is_mirrored({.stretch = 1.53, .in_middle = 1.2, .spread = -0.09, .patterned = 1.0}));
  EXPECT_FALSE(internal::is_mirrored({.stretch = 0.66, .in_middle = 1.29, .spread = 0.4, .patterned = 1.0}));
  EXPECT_FALSE(internal::is_mirrored({.stretch = 1.63, .in_middle = 1.59, .spread = -0.52, .patterned = 0.92}));
  EXPECT_FALSE(internal::is_mirrored({.stretch = 0.63, .in_middle = -0.07, .spread = 0.04, .patterned = 1.0}));
}

// Beside the axis of a near camera the outline is an ellipse; a circle of its smaller half-axis lies inside it.
TEST(RimStretch, AnEllipseIsTakenForItsCircle) {
  const internal::Ellipse wide{{300, 250}, Vec2(0.8, 0.6), 195, 180};
  const Disc disc{wide.centre.x(), wide.centre.y(), wide.minor};
  const MirrorBall ball{{0, 0, 1}};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const test::SoftRoom room(seed, 0.5);
    const auto picture_of = [&](const auto& squeezed) {
      Image<float> picture(600, 500, 1);
      for (int y = 0; y < 500; ++y) {
        for (int x = 0; x < 600; ++x) {
          const Vec2 p = (squeezed(Vec2(x + 0.5, y + 0.5)) - wide.centre) / wide.minor;
          const auto d = ball.dir_from_px(p);
          picture(x, y) = d ? static_cast<float>(room(*d, 1)) : 1.0f;
        }
      }
      return picture;
    };
    const auto round = rim_stretch(picture_of([](const Vec2& px) { return px; }), internal::circle_of(disc), 1e-3);
    const auto oval = rim_stretch(picture_of([&](const Vec2& px) { return wide.squeezed(px); }), wide, 1e-3);
    EXPECT_NEAR(oval.stretch, round.stretch, 0.08) << "seed " << seed;
    EXPECT_NEAR(oval.spread, round.spread, 0.05) << "seed " << seed;
  }
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
