// Weights of codes: the inverse of what a residual of [Debevec97] eq. 3 is expected to be.
#include "libhdr/response/internal/code_weights.h"

#include <algorithm>
#include <cmath>

namespace hdr {

double hat_weight(double code, double max_code) {
  return std::max(0.02, std::min(code, max_code - code) / (0.5 * max_code));
}

namespace {

constexpr int kWindow = 9;  ///< pixels whose mean a point is (sample_points)

/// What the light itself varies by from shot to shot, and what resampling does, ln: clouds, lamps, a tenth of a pixel.
constexpr double kLight = 0.003;

std::vector<double> hat_samples(int count) {
  std::vector<double> samples;
  for (int k = 0; k < count; ++k) samples.push_back(hat_weight(k, count - 1));
  return samples;
}

/// The variance of g(Z), Z a window's mean. The noise of pixels averages out; rounding and what compression does are
/// much the same all over a smooth window, and do not.
double variance_of_g(const Response& response, int channel, const NoiseModel& noise, double code, double step) {
  const double max_code = std::ldexp(1.0, response.bits) - 1, full_well = response.exposure(channel, max_code);
  const double level = response.exposure(channel, code) / full_well;
  const double below = std::max(0.0, code - step), above = std::min(max_code, code + step);
  const double slope =
      (response.exposure(channel, above) - response.exposure(channel, below)) / ((above - below) * full_well);
  const double pixel = noise.stddev(level);
  const double coding = slope * slope * (1.0 / 12 + noise.code_noise * noise.code_noise);
  return (pixel * pixel / kWindow + coding) / (level * level) + kLight * kLight;
}

double sum_of_squares(const CodeWeights& weights, const Eigen::MatrixXd& codes) {
  double sum = 0;
  for (const double code : codes.reshaped()) {
    if (!std::isnan(code)) sum += weights.at(code) * weights.at(code);
  }
  return sum;
}

}  // namespace

CodeWeights::CodeWeights(int bits, std::vector<double> samples)
    : samples_a_code_(static_cast<double>(samples.size() - 1) / (std::ldexp(1.0, bits) - 1)),
      samples_(std::move(samples)) {}

CodeWeights CodeWeights::hat(int bits) {
  return {bits, hat_samples(response_levels(bits))};
}

CodeWeights CodeWeights::from_noise(const Response& response, int channel, const NoiseModel& noise,
                                    const Eigen::MatrixXd& codes) {
  const double max_code = std::ldexp(1.0, response.bits) - 1;
  const int count = response_levels(response.bits);
  const double step = max_code / (count - 1);
  std::vector<double> samples;
  for (int k = 0; k < count; ++k) {
    const double code = std::max(0.5, static_cast<double>(k)) * step;  // code 0 has no logarithm
    samples.push_back(1 / std::sqrt(variance_of_g(response, channel, noise, code, step)));
  }
  CodeWeights weights(response.bits, std::move(samples));
  const double squares = sum_of_squares(weights, codes), hat_squares = sum_of_squares(hat(response.bits), codes);
  if (squares > 0) {
    for (double& each : weights.samples_) each *= std::sqrt(hat_squares / squares);
  }
  return weights;
}

double CodeWeights::at(double code) const {
  const double at = std::clamp(code * samples_a_code_, 0.0, static_cast<double>(samples_.size() - 1));
  const auto k = std::min(static_cast<std::size_t>(at), samples_.size() - 2);
  const double t = at - static_cast<double>(k);
  return (1 - t) * samples_[k] + t * samples_[k + 1];
}

}  // namespace hdr
