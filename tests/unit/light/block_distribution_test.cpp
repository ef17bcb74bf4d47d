#include "libhdr/light/block_distribution.h"

#include <gtest/gtest.h>

#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

// The widest maps there are: every pixel that is not black must be drawn by some u, beside a sun of 1e6 too.
TEST(BlockDistribution, NoPixelOfAWideRowIsOutOfReach) {
  constexpr int kWidth = 16384;
  Random random(3, 3);
  Image<float> map(kWidth, 4, 3);
  for (int x = 0; x < kWidth; ++x) {
    map(x, 0, 1) = 1;
    map(x, 1, 1) = static_cast<float>(std::exp(20 * random.uniform() - 10));
    map(x, 2, 0) = random.uniform() < 0.3 ? 0.01f : 0.0f;
    map(x, 3, 2) = x == 7777 ? 1e6f : 1e-3f;
  }
  const BlockDistribution distribution(map, 0);
  for (int y = 0; y < 4; ++y) {
    int missed = 0;
    for (int x = 0; x < kWidth; ++x) {
      const double u = distribution.invert(y, {x, 0.5});
      const BlockDistribution::Place place = distribution.place_of(y, u);
      if (distribution.weight(x, y) > 0) {
        missed += place.x != x;
        EXPECT_NEAR(place.inside, 0.5, 1e-3) << x << ' ' << y;
      } else {
        EXPECT_GT(distribution.weight(place.x, y), 0) << "a black pixel was drawn";
      }
    }
    EXPECT_EQ(missed, 0) << "row " << y;
  }
}

TEST(BlockDistribution, SharesAreTheWeights) {
  Random random(5, 3);
  for (const int width : {1, 2, 31, 32, 33, 64, 100}) {
    for (const double floor : {0.0, 0.4}) {
      Image<float> map(width, 1, 3);
      double total = 0;
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c) map(x, 0, c) = static_cast<float>(random.uniform());
        total += std::max(0.0, 0.2126 * map(x, 0, 0) + 0.7152 * map(x, 0, 1) + 0.0722 * map(x, 0, 2) - floor);
      }
      const BlockDistribution distribution(map, floor);
      EXPECT_NEAR(distribution.row_total(0), total, 1e-12 * total + 1e-12);
      if (!(total > 0)) continue;
      for (int x = 0; x < width; ++x) {
        const double share = distribution.invert(0, {x, 1 - 0x1p-50}) - distribution.invert(0, {x, 0});
        EXPECT_NEAR(share, distribution.weight(x, 0) / total, 1e-12) << x << " of " << width;
      }
      for (const double u : {0.0, 0.25, 1 - 0x1p-53})
        EXPECT_GT(distribution.weight(distribution.place_of(0, u).x, 0), 0);
    }
  }
}

TEST(BlockDistribution, ARowOfNoWeightIsUniform) {
  const Image<float> black(50, 2, 3);
  const BlockDistribution distribution(black, 0);
  for (int x = 0; x < 50; ++x) EXPECT_EQ(distribution.place_of(1, (x + 0.5) / 50).x, x);
}

}  // namespace
}  // namespace hdr
