#include "libhdr/light/block_distribution.h"

#include <gtest/gtest.h>

#include "libhdr/core/parallel.h"
#include "libhdr/light/block_alias.h"
#include "libhdr/light/internal/pixel_block.h"
#include "libhdr/light/step_distribution.h"
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

// How many pixels of a map that have light no numbers (u, v) lead to. Suns of 1e6 and black pixels among a ground of
// 1e-3 to 1. Whether u leads to a column is decided in its row alone, and whether v leads to a row by the rows' totals:
// a band of rows at a time is as good as all of a map that would fill 1.6 GB.
struct OfRow {
  double total = 0;
  std::int64_t lit = 0, missed = 0;
};

template <class Columns>
OfRow count_in_row(const Columns& columns, int y, int width, bool pixels) {
  OfRow row{columns.row_total(y)};
  for (int x = 0; pixels && x < width; ++x) {
    if (!(columns.weight(x, y) > 0)) continue;
    ++row.lit;
    row.missed += columns.place_of(y, columns.invert(y, {x, 0.5})).x != x;
  }
  return row;
}

Image<float> band_of(int first, int rows, int width) {
  Image<float> map(width, rows, 3);
  for (int y = 0; y < rows; ++y) {
    Random random(8, static_cast<std::uint64_t>(first + y));
    for (int x = 0; x < width; ++x) {
      const double u = random.uniform();
      map(x, y, 1) = u < 0.1 ? 0.0f : u > 0.9999 ? 1e6f : std::exp(static_cast<float>(7 * u - 7));
    }
  }
  return map;
}

// The pixels of one row in `every`, beside the totals of all.
void expect_all_reached(Size size, int every = 1) {
  constexpr int kBand = 32;
  std::vector<OfRow> counts[2];  // in order, alias tables
  for (auto& count : counts) count.resize(static_cast<std::size_t>(size.height));
  for_rows(size.height, kBand, [&](int first, int last) {
    const Image<float> map = band_of(first, last - first, size.width);
    const BlockDistribution in_order(map, 0);
    const BlockAlias alias(map, 0);
    for (int y = first; y < last; ++y) {
      counts[0][static_cast<std::size_t>(y)] = count_in_row(in_order, y - first, size.width, y % every == 0);
      counts[1][static_cast<std::size_t>(y)] = count_in_row(alias, y - first, size.width, y % every == 0);
    }
  });
  for (const auto& count : counts) {
    std::vector<double> weights;
    for (int y = 0; y < size.height; ++y)
      weights.push_back(count[static_cast<std::size_t>(y)].total *
                        latlong_pixel_solid_angle(y, size.width, size.height));
    const StepDistribution rows(weights);
    std::int64_t lit = 0, missed = 0;
    for (int y = 0; y < size.height; ++y) {
      const OfRow& row = count[static_cast<std::size_t>(y)];
      lit += row.lit;
      const bool row_reached = rows.step_of(rows.invert({y, 0.5})).index == y;
      EXPECT_TRUE(row_reached || row.total == 0) << "row " << y;
      missed += row_reached ? row.missed : row.lit;
    }
    EXPECT_GT(lit, std::int64_t{size.width} * size.height * 4 / 5 / every);
    EXPECT_EQ(missed, 0) << "of " << lit << (&count == counts ? "" : ", alias tables");
  }
}

TEST(BlockDistribution, EveryPixelOfAMapThatHasLightIsReached) {
  expect_all_reached({1024, 512});
  expect_all_reached({1000, 33});
}

// Every row, and all pixels of every fourth: 34 millions.
TEST(BlockDistribution, PixelsOfTheWidestMapAreReached) {
  expect_all_reached({16384, 8192}, 4);
}

// 30 s of CPU: run with --gtest_also_run_disabled_tests.
TEST(BlockDistribution, DISABLED_EveryPixelOfTheWidestMapIsReached) {
  expect_all_reached({16384, 8192});
}

TEST(PixelBlock, VectorsSayWhatTheReferenceSays) {
  Random random(17, 3);
  for (const int width : {1, 7, 15, 16, 17, 31, 32, 48, 100, 240}) {
    for (const double floor : {0.0, 0.3}) {
      std::vector<float> row(static_cast<std::size_t>(3 * width));
      for (float& value : row) value = random.uniform() < 0.3 ? 0 : static_cast<float>(random.uniform());
      const auto count = static_cast<std::size_t>((width + kPixelBlock - 1) / kPixelBlock);
      std::vector<double> fast(count), slow(count);
      const Rgb a = sum_blocks(row.data(), width, floor, fast.data());
      const Rgb b = reference::sum_blocks(row.data(), width, floor, slow.data());
      EXPECT_LT((a - b).abs().maxCoeff(), 1e-12);
      for (std::size_t k = 0; k < count; ++k) {
        EXPECT_NEAR(fast[k], slow[k], 1e-13);
        if (!(slow[k] > 0)) continue;
        const int pixels = std::min(kPixelBlock, width - static_cast<int>(k) * kPixelBlock);
        const float* block = row.data() + 3 * kPixelBlock * k;
        for (int i = 0; i < 50; ++i) {
          const double share = i == 0 ? 0 : random.uniform();
          const PixelPlace place = place_in_block(block, pixels, floor, share * slow[k]);
          const PixelPlace meant = reference::place_in_block(block, pixels, floor, share * slow[k]);
          const PixelPlace of_share = place_of_share(block, pixels, floor, share);
          EXPECT_EQ(place.index, meant.index);
          EXPECT_NEAR(place.inside, meant.inside, 1e-9);
          EXPECT_NEAR(place.weight, meant.weight, 1e-15);
          EXPECT_EQ(of_share.index, meant.index);
        }
        // At the end and past it, by rounding: the last pixel that has weight.
        const PixelPlace end = place_in_block(block, pixels, floor, slow[k] * (1 + 1e-12));
        EXPECT_EQ(end.index, reference::place_in_block(block, pixels, floor, slow[k] * (1 + 1e-12)).index);
        EXPECT_GT(end.weight, 0);
      }
    }
  }
}

TEST(BlockAlias, SharesAreTheWeights) {
  Random random(5, 3);
  for (const int width : {1, 16, 17, 64, 160, 1000}) {
    Image<float> map(width, 2, 3);
    std::vector<double> blocks(static_cast<std::size_t>((width + 15) / 16)), found(blocks.size());
    for (int x = 0; x < width; ++x) map(x, 0, 1) = static_cast<float>(std::exp(9 * random.uniform()));
    for (int x = 0; x < std::min(width, 16); ++x) map(x, 0, 1) = 1e-9f;  // a block that all but vanishes
    const BlockAlias alias(map, 0);
    sum_blocks(map.row(0), width, 0, blocks.data());
    constexpr int kSteps = 200000;
    for (int k = 0; k < kSteps; ++k)
      found[static_cast<std::size_t>(alias.place_of(0, (k + 0.5) / kSteps).x / 16)] += 1.0 / kSteps;
    for (std::size_t k = 0; k < blocks.size(); ++k)
      EXPECT_NEAR(found[k], blocks[k] / alias.row_total(0), 2.0 * static_cast<double>(blocks.size()) / kSteps) << k;
    for (int x = 0; x < std::min(width, 16); ++x) EXPECT_EQ(alias.place_of(0, alias.invert(0, {x, 0.5})).x, x);
    EXPECT_EQ(alias.place_of(1, 0.99).x, static_cast<int>(0.99 * width)) << "a black row is uniform";
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
