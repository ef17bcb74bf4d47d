#include "libhdr/merge/weight.h"

#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

/// Deviation of a middle code of a lossy file, relative: about half a code of 128 through a gamma of 2.2.
constexpr double kLossyDeviation = 0.01;

/// The code, between integers, whose exposure is `exposure`.
double code_of_exposure(const Response& response, int channel, double exposure) {
  double low = 0, high = std::ldexp(1.0, response.bits) - 1;
  while (high - low > 1e-3) {
    const double middle = 0.5 * (low + high);
    (response.exposure(channel, middle) < exposure ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// d exp(g) / d code, over the cell of the code.
double slope(const Response& response, int channel, double code) {
  const double max_code = std::ldexp(1.0, response.bits) - 1;
  const double below = std::max(0.0, code - 1), above = std::min(max_code, code + 1);
  return (response.exposure(channel, above) - response.exposure(channel, below)) / (above - below);
}

}  // namespace

int first_clipped_code(int bits, bool lossy) {
  const int max_code = (1 << bits) - 1;
  return lossy ? static_cast<int>(std::ceil(252.0 / 255 * max_code)) : max_code;
}

BlackPoint black_point(const Response& response, int channel, std::optional<double> black_level) {
  BlackPoint black{response.black_code(channel), 0};
  if (black_level) {
    black.black_code = std::max(black.black_code, static_cast<int>(std::floor(*black_level)));
    black.offset = response.exposure(channel, *black_level);
  }
  return black;
}

std::vector<double> light_table(const Response& response, int channel, const BlackPoint& black) {
  std::vector<double> light(std::size_t{1} << response.bits);
  // g(0) is the middle of code 0's cell already; above a pedestal that is subtracted the cell starts at no light.
  const double dark = black.offset > 0 ? 0.5 * (response.exposure(channel, black.black_code + 0.5) - black.offset)
                                       : response.exposure(channel, 0);
  for (std::size_t code = 0; code < light.size(); ++code) {
    light[code] = static_cast<int>(code) <= black.black_code
                      ? std::max(0.0, dark)
                      : std::max(0.0, response.exposure(channel, static_cast<double>(code)) - black.offset);
  }
  return light;
}

double exposure_variance(const Response& response, int channel, const NoiseModel& noise, double exposure) {
  const double full_well = response.exposure(channel, std::ldexp(1.0, response.bits) - 1);
  const double sensor = noise.stddev(exposure / full_well) * full_well;
  const double per_code = slope(response, channel, code_of_exposure(response, channel, exposure));
  return sensor * sensor + per_code * per_code * (1.0 / 12 + noise.code_noise * noise.code_noise);
}

std::vector<float> hat_weights(const Response& response, int channel, bool lossy, const NoiseModel& noise,
                               const BlackPoint& black) {
  const double max_code = std::ldexp(1.0, response.bits) - 1;
  const double full_well = response.exposure(channel, max_code);
  const std::vector<double> light = light_table(response, channel, black);
  std::vector<float> weights(light.size());
  for (int code = black.black_code + 1; code < first_clipped_code(response.bits, lossy); ++code) {
    const auto k = static_cast<std::size_t>(code);
    if (!(light[k] > 0)) continue;  // a curve that is still flat above the black level
    const double value = (code - black.black_code) / (max_code - black.black_code);
    const double sensor = noise.stddev((light[k] + black.offset) / full_well) * full_well;
    const double deviation = kLossyDeviation * light[k] / (1 - std::abs(2 * value - 1));
    weights[k] = static_cast<float>(light[k] / (sensor * sensor + deviation * deviation));
  }
  return weights;
}

}  // namespace hdr
