// A sun that was clipped on purpose comes back, and nothing else changes.
#include "libhdr/light/restore_clipped.h"

#include <gtest/gtest.h>

#include "libhdr/light/lights.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

struct World {
  Image<float> truth, clipped;
};

constexpr float kClip = 50;

// A sky with suns of some pixels each, clipped at kClip.
World clipped_world(std::uint64_t seed, int suns) {
  World world{test::lobes_map({96, 48}, 3, 8, seed), Image<float>(96, 48, 3)};
  Random random(seed, 5);
  for (int s = 0; s < suns; ++s) {
    const int x0 = 8 + s * 96 / suns, y0 = 6 + static_cast<int>(random.uniform() * 10);
    const double size = std::exp(3 * random.uniform());
    for (int y = y0; y < y0 + 2; ++y)
      for (int x = x0; x < x0 + 2; ++x)
        for (int c = 0; c < 3; ++c) world.truth(x, y, c) = static_cast<float>(kClip * size * (3 + 0.5 * c));
  }
  for (int y = 0; y < 48; ++y)
    for (int k = 0; k < 3 * 96; ++k) world.clipped.row(y)[k] = std::min(kClip, world.truth.row(y)[k]);
  return world;
}

std::vector<MeasuredIrradiance> readings(const World& world, int count) {
  Random random(1, 1);
  const std::vector<DirectionalLight> pixels = pixel_lights(world.truth);
  std::vector<MeasuredIrradiance> list{{Vec3::UnitY(), irradiance(pixels, Vec3::UnitY())}};
  while (static_cast<int>(list.size()) < count) {
    Vec3 n = test::random_dir(random);
    n.y() = std::abs(n.y());
    list.push_back({n, irradiance(pixels, n)});
  }
  return list;
}

TEST(RestoreClipped, OneSunFromOneReading) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const World world = clipped_world(seed, 1);
    const Image<std::uint8_t> mask = clipped_mask(world.clipped);
    const Restored result = restore_clipped(world.clipped, mask, readings(world, 1));
    EXPECT_EQ(result.regions, 1);
    EXPECT_LT(result.residual.maxCoeff(), 1e-9);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 96; ++x) {
        for (int c = 0; c < 3; ++c) {
          if (mask(x, y)) {
            EXPECT_NEAR(result.rgb(x, y, c) / world.truth(x, y, c), 1, 1e-4);
          } else {
            EXPECT_EQ(result.rgb(x, y, c), world.clipped(x, y, c)) << "a pixel that is not clipped was changed";
          }
        }
      }
    }
  }
}

TEST(RestoreClipped, SeveralSunsFromABall) {
  const World world = clipped_world(3, 3);
  const Restored result = restore_clipped(world.clipped, clipped_mask(world.clipped), readings(world, 40));
  EXPECT_EQ(result.regions, 3);
  EXPECT_LT(result.residual.maxCoeff(), 1e-4);
  double worst = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 96; ++x)
      worst = std::max<double>(worst, std::abs(result.rgb(x, y, 1) / world.truth(x, y, 1) - 1));
  EXPECT_LT(worst, 0.01);
}

TEST(RestoreClipped, AReadingBelowTheMapChangesNothingAndSaysSo) {
  const World world = clipped_world(2, 1);
  std::vector<MeasuredIrradiance> low = readings(world, 1);
  low[0].irradiance *= 0.01;
  const Restored result = restore_clipped(world.clipped, clipped_mask(world.clipped), low);
  EXPECT_TRUE((result.gains[0] == 1).all());
  EXPECT_GT(result.residual.minCoeff(), 0.5);
}

TEST(RestoreClipped, NeedsReadingsAndClippedPixels) {
  const World world = clipped_world(2, 1);
  EXPECT_THROW(restore_clipped(world.clipped, clipped_mask(world.clipped), {}), Error);
  EXPECT_THROW(restore_clipped(world.clipped, clipped_mask(world.clipped, 1e9), readings(world, 1)), Error);
}

}  // namespace
}  // namespace hdr
