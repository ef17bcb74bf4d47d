#include "libhdr/merge/weight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/response/noise.h"

namespace hdr {
namespace {

/// Weight against that of the middle code (where exp(g) is 1) when both see one radiance: H is then as exp(g).
double relative_weight(const Response& response, const std::vector<float>& weights, int code) {
  const double exposure = response.exposure(0, code);
  return weights[static_cast<std::size_t>(code)] * exposure / weights[weights.size() / 2];
}

std::vector<float> weights_of(const Response& response, bool lossy) {
  return hat_weights(response, 0, lossy, {}, black_point(response, 0, std::nullopt));
}

TEST(HatWeights, BlackAndClippedCodesHaveNone) {
  for (const int bits : {8, 16}) {
    const Response response = srgb_response(bits);
    for (const bool lossy : {false, true}) {
      const std::vector<float> weights = weights_of(response, lossy);
      const auto clipped = static_cast<std::size_t>(first_clipped_code(bits, lossy));
      EXPECT_EQ(weights[0], 0);
      for (std::size_t code = 1; code < clipped; ++code) ASSERT_GT(weights[code], 0) << code;
      for (std::size_t code = clipped; code < weights.size(); ++code) ASSERT_EQ(weights[code], 0) << code;
    }
  }
  EXPECT_EQ(first_clipped_code(8, true), 252);
  EXPECT_EQ(first_clipped_code(8, false), 255);
}

// "To zero at both ends faster than the hat": against the middle, less than the hat's share.
TEST(HatWeights, FallFasterThanTheHatAtBothEnds) {
  const Response response = srgb_response(8);
  const std::vector<float> weights = weights_of(response, true);
  for (const int code : {2, 8, 20, 240, 245, 251}) {
    const double hat = std::min(code, 255 - code) / 127.5;
    EXPECT_LT(relative_weight(response, weights, code), 0.5 * hat) << code;
  }
}

TEST(HatWeights, NothingBelowABlackLevelCounts) {
  Response response = gamma_response(8, 2);
  for (std::size_t code = 0; code <= 16; ++code) response.g[0][code] = response.g[0][16];
  const std::vector<float> weights = weights_of(response, false);
  for (std::size_t code = 0; code <= 16; ++code) EXPECT_EQ(weights[code], 0) << code;
  EXPECT_GT(weights[17], 0);
  EXPECT_LT(relative_weight(response, weights, 18), 0.05 * relative_weight(response, weights, 60))
      << "the pedestal's noise reaches a little above it";
}

// Shot noise, read noise and rounding, by hand for a linear curve: variance of Z is Z k + read^2 k^2 + 1/12 codes^2.
TEST(ExposureVariance, IsShotNoiseReadNoiseRoundingAndCompression) {
  const Response response = linear_response(8);
  for (const double code_noise : {0.0, 1.5}) {
    const NoiseModel camera{20000, 8, code_noise};
    const double k = 255 / camera.full_well;  // codes for an electron
    const double per_code = (response.exposure(0, 200) - response.exposure(0, 100)) / 100;
    for (const int code : {2, 10, 50, 200, 240}) {
      const double codes_squared =
          code * k + camera.read_noise * camera.read_noise * k * k + 1 / 12.0 + code_noise * code_noise;
      const double found = exposure_variance(response, 0, camera, response.exposure(0, code));
      EXPECT_NEAR(found / (codes_squared * per_code * per_code), 1, 1e-3) << code;
    }
  }
}

// Through a gamma of 2 a code is worth more light the brighter it is: d light / d code ~ code.
TEST(ExposureVariance, RoundingGoesThroughTheSlopeOfTheCurve) {
  const Response response = gamma_response(8, 2);
  const NoiseModel silent{1e12, 0};
  const double dim = exposure_variance(response, 1, silent, response.exposure(1, 40));
  const double bright = exposure_variance(response, 1, silent, response.exposure(1, 160));
  EXPECT_NEAR(bright / dim, 16, 0.2);
}

TEST(BlackPoint, TakesTheHigherOfTheResponsesAndTheGiven) {
  Response response = gamma_response(8, 2);
  EXPECT_EQ(black_point(response, 0, std::nullopt).black_code, 0);
  EXPECT_EQ(black_point(response, 0, std::nullopt).offset, 0);
  const BlackPoint given = black_point(response, 0, 20.0);
  EXPECT_EQ(given.black_code, 20);
  EXPECT_NEAR(given.offset / response.exposure(0, 20), 1, 1e-12);
  const std::vector<double> light = light_table(response, 0, given);
  EXPECT_NEAR(light[100], response.exposure(0, 100) - response.exposure(0, 20), 1e-9);
  EXPECT_EQ(light[3], light[20]) << "codes at or under it mean one thing";
  EXPECT_LT(light[20], light[21]);
}

}  // namespace
}  // namespace hdr
