// What a shot says between its pixels.
#include "libhdr/merge/internal/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "libhdr/core/random.h"
#include "libhdr/response/response.h"

namespace hdr::internal {
namespace {

constexpr Size kSize{70, 50};

Image<std::uint16_t> picture(const std::function<double(int, int)>& level) {
  Image<std::uint16_t> codes(kSize, 3);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        codes(x, y, c) = static_cast<std::uint16_t>(std::lround(65535 * std::clamp(level(x, y), 0.0, 1.0)));
      }
    }
  }
  return codes;
}

Mat3 moved_by(double dx, double dy) {
  Mat3 photo_from_ref = Mat3::Identity();
  photo_from_ref(0, 2) = dx;
  photo_from_ref(1, 2) = dy;
  return photo_from_ref;
}

MergeModel lossless(WeightKind kind = WeightKind::kVariance) {
  return make_merge_model(linear_response(16), {false, kind, {}, {}, {}});
}

std::vector<WarpedRow> warped(const MergeModel& model, const Image<std::uint16_t>& codes, const Mat3& photo_from_ref,
                              const Block& block = {0, 0, kSize.width, kSize.height}) {
  std::vector<WarpedRow> rows(static_cast<std::size_t>(block.y1 - block.y0), WarpedRow(block.x1 - block.x0));
  Resampler::Patch patch;
  Resampler(model, photo_from_ref, kSize).warp(CodesView(codes.view()), 0, block, patch, rows);
  return rows;
}

float level_at(const std::vector<WarpedRow>& rows, int x, int y) {
  return rows[static_cast<std::size_t>(y)].level[1][static_cast<std::size_t>(x)];
}

TEST(Resample, ParabolasComeBackExactlyAndBilinearSharesWouldNotDo) {
  const auto parabola = [](double x, double y) { return 0.2 + 1e-4 * (x - 30) * (x - 30) + 5e-5 * (y - 20) * (x + y); };
  const MergeModel model = lossless();
  for (const double t : {0.25, 0.5, 0.9}) {
    const auto rows = warped(model, picture(parabola), moved_by(t, -t));
    for (int y = 5; y < 40; ++y) {
      for (int x = 5; x < 60; ++x) ASSERT_NEAR(level_at(rows, x, y), parabola(x + t, y - t), 2.5e-5) << x << " " << y;
    }
  }
}

// A wave of four pixels, half a pixel on: [Keys81]'s kernel leaves .884 of it, bilinear shares .707.
TEST(Resample, FineTextureIsNotBlurredAwayLikeBilinear) {
  const double w = std::acos(-1.0) / 2;
  const auto rows =
      warped(lossless(), picture([&](int x, int) { return 0.5 + 0.4 * std::cos(w * x); }), moved_by(0.5, 0));
  double most = 0;
  for (int x = 8; x < 60; ++x) most = std::max(most, std::abs(level_at(rows, x, 20) - 0.5) / (0.4 * std::cos(w / 2)));
  EXPECT_NEAR(most, 0.884, 0.005);
}

TEST(Resample, NothingRingsBeyondTheSixteenValues) {
  Random random(3, 1);
  const Image<std::uint16_t> codes =
      picture([&](int, int) { return random.uniform() < 0.2 ? 0.9 : 0.001 + 0.001 * random.uniform(); });
  const auto rows = warped(lossless(), codes, moved_by(0.37, 0.61));
  for (int y = 3; y < 46; ++y) {
    for (int x = 3; x < 66; ++x) {
      std::uint16_t least = 65535, most = 0;
      for (int k = 0; k < 16; ++k) {
        const std::uint16_t code = codes(x - 1 + k % 4, y - 1 + k / 4, 1);
        least = std::min(least, code);
        most = std::max(most, code);
      }
      ASSERT_GE(level_at(rows, x, y), 0.99999 * least / 65535);
      ASSERT_LE(level_at(rows, x, y), 1.00001 * most / 65535);
    }
  }
}

TEST(Resample, InformationIsTheNoiseThatTheMeanTakesAway) {
  Random random(9, 2);
  const Image<std::uint16_t> codes = picture([&](int, int) { return 0.5 + 0.02 * random.normal(); });
  for (const double t : {0.0, 0.2, 0.5}) {
    const auto rows = warped(lossless(), codes, moved_by(t, 0.5));
    double squares = 0, count = 0;
    for (int y = 2; y < 46; ++y) {
      for (int x = 2; x < 66; ++x) {
        squares += std::pow((level_at(rows, x, y) - 0.5) / 0.02, 2);
        ++count;
      }
    }
    EXPECT_NEAR(squares / count * rows[10].information[1][20], 1, 0.08) << t;
  }
  EXPECT_NEAR(warped(lossless(), codes, moved_by(0.5, 0.5))[10].information[1][20], 1 / (0.640625 * 0.640625), 1e-4);
}

TEST(Resample, WhatLacksAClippedNeighbourIsHardlyBelieved) {
  const Image<std::uint16_t> codes = picture([](int x, int) { return x < 30 ? 0.1 : 1.0; });
  const auto rows = warped(lossless(), codes, moved_by(0.25, 0));
  const auto trust = [&](std::size_t x) { return rows[20].trust[1][x]; };
  EXPECT_NEAR(level_at(rows, 29, 20), 0.1, 1e-4) << "the unclipped neighbour speaks for it";
  EXPECT_LT(trust(29), 1e-3);
  EXPECT_NEAR(level_at(rows, 28, 20), 0.1, 1e-4) << "the cubic would ring here";
  EXPECT_EQ(trust(28), 1);
  EXPECT_GE(level_at(rows, 30, 20), 1 - 1e-6);
  // Half a code's share of a clipped neighbour is none when the shot stands on the pixel.
  EXPECT_EQ(warped(lossless(), codes, moved_by(1, 0))[20].trust[1][28], 1);
}

TEST(Resample, TheHatWeighsTheLightThatWasMadeNotTheCodesItIsMadeOf) {
  const MergeModel model = lossless(WeightKind::kHat);
  const Image<std::uint16_t> codes = picture([](int x, int) { return 0.1 + 0.01 * x; });
  const auto rows = warped(model, codes, moved_by(0.5, 0));
  for (std::size_t x = 5; x < 60; ++x) {
    const float weight = rows[20].weight[1][x], light = rows[20].weight_light[1][x] / weight;
    EXPECT_NEAR(light / model.channel[1].saturation, 0.1 + 0.01 * (static_cast<double>(x) + 0.5), 2e-5);
    const auto code = static_cast<std::size_t>(std::lround(65535 * (0.1 + 0.01 * (static_cast<double>(x) + 0.5))));
    EXPECT_NEAR(weight / model.channel[1].weight[code], 1, 0.06) << "bins of the level are 1/32 octave wide";
  }
}

TEST(Resample, TrustFallsToTheBorderAndOutsideThereIsNothing) {
  const auto rows = warped(lossless(), picture([](int, int) { return 0.3; }), moved_by(10.3, 0));
  const std::vector<float>& trust = rows[25].trust[1];
  EXPECT_EQ(trust[40], 1);
  for (std::size_t x = 50; x < 59; ++x) EXPECT_LE(trust[x + 1], trust[x]);
  EXPECT_LT(trust[59], 0.1);
  EXPECT_GT(trust[59], 0);
  EXPECT_EQ(level_at(rows, 60, 25), -1);
}

TEST(Resample, AnyHomographyAndAnyBlocksGiveTheSameBytes) {
  Random random(1, 1);
  const Image<std::uint16_t> codes = picture([&](int, int) { return random.uniform(); });
  Mat3 turned, tilted;
  turned << 0, -1, 60, 1, 0, -10, 0, 0, 1;  // by 90 degrees
  tilted << 1.1, 0.2, -5, -0.1, 0.9, 3, 2e-3, -1e-3, 1;
  Mat3 behind = tilted;
  behind(2, 0) = -0.03;  // the camera's horizon crosses the picture
  for (const Mat3& photo_from_ref : {turned, tilted, behind}) {
    const auto whole = warped(lossless(), codes, photo_from_ref);
    for (int y = 0; y < kSize.height; y += 7) {
      const Block block{0, y, kSize.width, std::min(y + 7, kSize.height)};
      const auto part = warped(lossless(), codes, photo_from_ref, block);
      for (int row = block.y0; row < block.y1; ++row) {
        for (int x = 0; x < kSize.width; ++x) ASSERT_EQ(level_at(whole, x, row), level_at(part, x, row - y));
      }
    }
  }
  const auto rows = warped(lossless(), codes, turned);
  EXPECT_NEAR(level_at(rows, 20, 30), codes(30, 10, 1) / 65535.0, 1e-5);
}

}  // namespace
}  // namespace hdr::internal
