#include "libhdr/merge/weight.h"

#include <algorithm>
#include <cmath>

#include "libhdr/response/noise.h"

namespace hdr {
namespace {

/// Deviation of a middle code of a lossy file, relative: about half a code of 128 through a gamma of 2.2.
constexpr double kLossyDeviation = 0.01;

/// Variance of exp(g) from rounding: 1/12 code, through the slope of the curve.
double rounding_variance(const Response& response, int channel, double code, double max_code) {
  const double below = std::max(0.0, code - 1), above = std::min(max_code, code + 1);
  const double per_code = (response.exposure(channel, above) - response.exposure(channel, below)) / (above - below);
  return per_code * per_code / 12;
}

/// 1 inside, falling to zero as a square over the last `width` before an end.
double ramp(double distance, double width) {
  const double share = std::min(1.0, distance / width);
  return share * share;
}

}  // namespace

int first_clipped_code(int bits, bool lossy) {
  const int max_code = (1 << bits) - 1;
  return lossy ? static_cast<int>(std::ceil(252.0 / 255 * max_code)) : max_code;
}

std::vector<float> code_weights(const Response& response, int channel, bool lossy, WeightKind kind) {
  const double max_code = std::ldexp(1.0, response.bits) - 1;
  const bool hat = kind == WeightKind::kHat || (kind == WeightKind::kAuto && lossy);
  const int clipped = first_clipped_code(response.bits, lossy);
  const int black = response.black_code(channel);
  const double full_well = response.exposure(channel, max_code);
  std::vector<float> weights(static_cast<std::size_t>(max_code) + 1);
  for (int code = black + 1; code < clipped; ++code) {
    const double value = (code - black) / (max_code - black);
    const double exposure = response.exposure(channel, code);
    const double noise = NoiseModel{}.stddev(exposure / full_well) * full_well;
    double variance = noise * noise, trust = 1;
    if (hat) {
      const double deviation = kLossyDeviation * exposure / (1 - std::abs(2 * value - 1));
      variance += deviation * deviation;
    } else {
      variance += rounding_variance(response, channel, code, max_code);
      // Noise lifts some clipped light below the last code and cuts what is just under it: the ramp over the last 4 %
      // keeps both out while another shot can speak.
      trust = ramp(1 - value, 0.04) * (black > 0 ? ramp(value, 0.04) : 1.0);
    }
    weights[static_cast<std::size_t>(code)] = static_cast<float>(trust * exposure / variance);
  }
  return weights;
}

}  // namespace hdr
