#include "libhdr/merge/weight.h"

#include <algorithm>
#include <cmath>

#include "libhdr/response/noise.h"

namespace hdr {
namespace {

double squared_hat(double value) {
  const double hat = 1 - std::abs(2 * value - 1);
  return hat * hat;
}

/// Relative variance of exp(g) at a code: rounding (1/12 code, through the slope of the curve) and the noise of a
/// typical sensor.
double relative_variance(const Response& response, int channel, double code, double max_code) {
  const double below = response.exposure(channel, std::max(0.0, code - 1));
  const double above = response.exposure(channel, std::min(max_code, code + 1));
  const double exposure = response.exposure(channel, code);
  const double per_code = (above - below) / (std::min(max_code, code + 1) - std::max(0.0, code - 1));
  const double rounding = per_code * per_code / 12;
  const double full_well = response.exposure(channel, max_code);
  const double noise = NoiseModel{}.stddev(exposure / full_well) * full_well;
  return (rounding + noise * noise) / (exposure * exposure);
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
  std::vector<float> weights(static_cast<std::size_t>(max_code) + 1);
  for (int code = black + 1; code < clipped; ++code) {
    const double value = (code - black) / (max_code - black);
    double weight = 0;
    if (hat) {
      weight = squared_hat(value);
    } else {
      // Noise lifts some clipped light below the last code and cuts what is just under it: the ramp over the last 4 %
      // keeps both out while another shot can speak.
      const double under_white = std::min(1.0, (1 - value) / 0.04);
      const double over_pedestal = black > 0 ? std::min(1.0, value / 0.04) : 1.0;
      const double ramp = under_white * over_pedestal;
      weight = 1e-4 * ramp * ramp / relative_variance(response, channel, code, max_code);
    }
    weights[static_cast<std::size_t>(code)] = static_cast<float>(std::clamp(weight, 1e-8, 1e4));
  }
  return weights;
}

}  // namespace hdr
