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

TEST(CodeWeights, BlackAndClippedCodesHaveNone) {
  for (const int bits : {8, 16}) {
    const Response response = srgb_response(bits);
    for (const WeightKind kind : {WeightKind::kAuto, WeightKind::kHat, WeightKind::kVariance}) {
      for (const bool lossy : {false, true}) {
        const std::vector<float> weights = code_weights(response, 0, lossy, kind);
        const auto clipped = static_cast<std::size_t>(first_clipped_code(bits, lossy));
        EXPECT_EQ(weights[0], 0);
        for (std::size_t code = 1; code < clipped; ++code) ASSERT_GT(weights[code], 0) << code;
        for (std::size_t code = clipped; code < weights.size(); ++code) ASSERT_EQ(weights[code], 0) << code;
      }
    }
  }
  EXPECT_EQ(first_clipped_code(8, true), 252);
  EXPECT_EQ(first_clipped_code(8, false), 255);
}

// "To zero at both ends faster than the hat": against the middle, less than the hat's share.
TEST(CodeWeights, FallFasterThanTheHatAtBothEnds) {
  const Response response = srgb_response(8);
  const std::vector<float> weights = code_weights(response, 0, true, WeightKind::kHat);
  for (const int code : {2, 8, 20, 240, 245, 251}) {
    const double hat = std::min(code, 255 - code) / 127.5;
    EXPECT_LT(relative_weight(response, weights, code), 0.5 * hat) << code;
  }
}

// Shot noise, read noise and rounding, by hand for a linear curve: variance of Z is Z k + read^2 k^2 + 1/12 codes^2.
TEST(CodeWeights, VarianceWeightsAreTheInverseRelativeVarianceOfOneRadiance) {
  const Response response = linear_response(8);
  const std::vector<float> weights = code_weights(response, 0, false, WeightKind::kVariance);
  const NoiseModel camera;
  const double k = 255 / camera.full_well;  // codes for an electron
  const auto variance = [&](double z) { return z * k + camera.read_noise * camera.read_noise * k * k + 1 / 12.0; };
  for (const int code : {2, 10, 50, 200, 240}) {
    const double expected = (code / 128.0) * (code / 128.0) * variance(128) / variance(code);
    EXPECT_NEAR(relative_weight(response, weights, code) / expected, 1, 1e-3) << code;
  }
}

TEST(CodeWeights, NothingBelowABlackLevelCounts) {
  Response response = gamma_response(8, 2);
  for (std::size_t code = 0; code <= 16; ++code) response.g[0][code] = response.g[0][16];
  for (const WeightKind kind : {WeightKind::kHat, WeightKind::kVariance}) {
    const std::vector<float> weights = code_weights(response, 0, false, kind);
    for (std::size_t code = 0; code <= 16; ++code) EXPECT_EQ(weights[code], 0) << code;
    EXPECT_GT(weights[17], 0);
    EXPECT_LT(relative_weight(response, weights, 18), 0.05 * relative_weight(response, weights, 60))
        << "the pedestal's noise reaches a little above it";
  }
}

}  // namespace
}  // namespace hdr
