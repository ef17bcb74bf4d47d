// A matt ball photographed in the light of a map says what the map's clipped suns were.
#include "libhdr/light/diffuse_ball.h"

#include <gtest/gtest.h>

#include "libhdr/light/horizontal_irradiance.h"
#include "libhdr/light/lights.h"
#include "libhdr/probe/ball_normal.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

constexpr float kClip = 40;

struct World {
  Image<float> truth, clipped;
};

// A soft sky with suns of 2 x 2 pixels, the brightest some 60 times what is left of it, in colours of their own.
World world_with(int suns) {
  World world{test::lobes_map({96, 48}, 3, 8, 4), Image<float>(96, 48, 3)};
  const int places[][2] = {{30, 12}, {62, 16}, {50, 6}};
  for (int s = 0; s < suns; ++s)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x)
        for (int c = 0; c < 3; ++c)
          world.truth(places[s][0] + x, places[s][1] + y, c) =
              static_cast<float>(60.0 / (1 + s) * kClip * (1 - 0.1 * c));
  for (int y = 0; y < 48; ++y)
    for (int k = 0; k < 3 * 96; ++k) world.clipped.row(y)[k] = std::min(kClip, world.truth.row(y)[k]);
  return world;
}

// Lambert's law, pixel by pixel; `noise` relative.
Image<float> photograph(View<const float> light, const MirrorBall& ball, Size size, double albedo, double noise) {
  const std::vector<DirectionalLight> pixels = pixel_lights(light);
  Image<float> picture(size, 3);
  Random random(11, 2);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto normal = normal_from_px(ball, {x + 0.5, y + 0.5});
      const Rgb e = normal ? Rgb(irradiance(pixels, *normal) * albedo / kPi) : Rgb(Rgb::Constant(0.3));
      for (int c = 0; c < 3; ++c) picture(x, y, c) = static_cast<float>(e[c] * (1 + noise * random.normal()));
    }
  }
  return picture;
}

double energy_of(View<const float> map) {
  double sum = 0;
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x)
      if (map(x, y, 1) >= 0.9f * kClip) sum += latlong_pixel_solid_angle(y, map.width(), map.height()) * map(x, y, 1);
  return sum;
}

const MirrorBall kFar{{40, 42, 34}};

TEST(DiffuseBall, ReadsTheIrradianceOfItsNormals) {
  const World world = world_with(1);
  const std::vector<DirectionalLight> pixels = pixel_lights(world.truth);
  const MirrorBall near{{40, 42, 34}, 5}, aside = ball_in_photograph({60, 30, 24}, {120, 90}, 40);
  for (const MirrorBall& ball : {kFar, near, aside}) {
    const Image<float> picture = photograph(world.truth, ball, {120, 90}, 0.6, 0);
    const BallReadings result = read_diffuse_ball(picture, ball, Rgb::Constant(0.6));
    EXPECT_GT(result.readings.size(), 200u);
    EXPECT_EQ(result.unusable, 0);
    double largest = 0, worst = 0;
    for (const MeasuredIrradiance& m : result.readings) {
      const double e = irradiance(pixels, m.normal)[1];
      largest = std::max(largest, e);
      worst = std::max(worst, std::abs(m.irradiance[1] - e));
    }
    EXPECT_LT(worst, 0.02 * largest) << "a sun's shadow line crosses some cells";
  }
}

TEST(DiffuseBall, ASunComesBackWithAKnownAlbedoAndAnUnknownOne) {
  const World world = world_with(1);
  const Image<float> picture = photograph(world.truth, kFar, {80, 84}, 0.6, 0.01);
  for (const bool unknown : {false, true}) {
    const auto readings = read_diffuse_ball(picture, kFar, Rgb::Constant(unknown ? 1 : 0.6)).readings;
    const Restored result = restore_clipped(world.clipped, clipped_mask(world.clipped), readings, {unknown});
    ASSERT_EQ(result.regions, 1);
    EXPECT_NEAR(energy_of(result.rgb) / energy_of(world.truth), 1, 0.02) << unknown;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(result.rgb(30, 12, c) / world.truth(30, 12, c), 1, 0.03) << "and its colour";
      EXPECT_LT(std::abs(result.gains[0][c] - 60 * (1 - 0.1 * c)), 6 * result.deviations[0][c] + 0.6);
    }
    EXPECT_LT(result.residual.maxCoeff(), 0.03);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 96; ++x)
        ASSERT_TRUE(world.clipped(x, y, 1) == kClip || result.rgb(x, y, 1) == world.clipped(x, y, 1));
    EXPECT_NEAR(1 / result.scale, unknown ? 0.6 : 1, 0.01);
  }
}

TEST(DiffuseBall, TellsSunsApart) {
  const World world = world_with(3);
  const Image<float> picture = photograph(world.truth, kFar, {80, 84}, 0.6, 0.01);
  const auto readings = read_diffuse_ball(picture, kFar, Rgb::Constant(0.6)).readings;
  const Restored result = restore_clipped(world.clipped, clipped_mask(world.clipped), readings);
  ASSERT_EQ(result.regions, 3);
  EXPECT_NEAR(energy_of(result.rgb) / energy_of(world.truth), 1, 0.02);
  EXPECT_NEAR(result.rgb(30, 12, 1) / world.truth(30, 12, 1), 1, 0.05);
  EXPECT_NEAR(result.rgb(50, 6, 1) / world.truth(50, 6, 1), 1, 0.1);
}

// Where nothing of the ball is in the suns' shadow, light that misses and an albedo that is too low look more alike:
// the deviation says so.
TEST(DiffuseBall, KnowsWhenItCannotTellTheAlbedo) {
  World world = world_with(0);
  for (int c = 0; c < 3; ++c) world.truth(47, 23, c) = 60 * kClip;  // behind the camera's back, +Z
  for (int y = 0; y < 48; ++y)
    for (int k = 0; k < 3 * 96; ++k) world.clipped.row(y)[k] = std::min(kClip, world.truth.row(y)[k]);
  const auto doubt = [&](const World& w) {
    const auto readings = read_diffuse_ball(photograph(w.truth, kFar, {80, 84}, 0.6, 0.05), kFar).readings;
    const Restored r = restore_clipped(w.clipped, clipped_mask(w.clipped), readings, {true});
    return r.scale_deviation / r.scale;
  };
  EXPECT_GT(doubt(world), 1.5 * doubt(world_with(1)));
}

}  // namespace
}  // namespace hdr
