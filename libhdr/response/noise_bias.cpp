#include "libhdr/response/internal/noise_bias.h"

#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

constexpr double kBrightest = 0.35;  ///< share of the codes; above it the bias is below a hundredth of a code
constexpr int kPoints = 160;         ///< of the table, closer together where it is dark
constexpr int kNodes = 161;          ///< of the normal distribution, over +-5 deviations
constexpr double kReach = 5;

/// Expected mean of a window whose codes are all above 0 (the others were not taken), for light of true code `code`.
double expected_code(double level, double deviation, const std::vector<double>& thresholds) {
  double sum = 0, weights = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double z = kReach * (2.0 * i / (kNodes - 1) - 1);
    const double light = std::clamp(level + deviation * z, 0.0, 1.0);
    const auto code = std::upper_bound(thresholds.begin(), thresholds.end(), light) - thresholds.begin();
    if (code < 1) continue;
    const double weight = std::exp(-0.5 * z * z);
    sum += weight * static_cast<double>(code);
    weights += weight;
  }
  return weights > 0 ? sum / weights : 1;
}

struct BiasTable {
  std::vector<double> expected, code;  ///< rising

  double without_bias(double mean) const {
    if (!(mean < expected.back())) return mean + (code.back() - expected.back());
    const auto above = std::upper_bound(expected.begin(), expected.end(), mean);
    if (above == expected.begin()) return code.front();
    const auto k = static_cast<std::size_t>(above - expected.begin());
    const double t = (mean - expected[k - 1]) / (expected[k] - expected[k - 1]);
    return code[k - 1] + t * (code[k] - code[k - 1]);
  }
};

BiasTable bias_table(const Response& response, int channel, const NoiseModel& noise) {
  const double max_code = std::ldexp(1.0, response.bits) - 1;
  const double full_well = response.exposure(channel, max_code);
  std::vector<double> thresholds = response.exposure_thresholds(channel);
  for (double& each : thresholds) each /= full_well;
  BiasTable table;
  for (int k = 1; k <= kPoints; ++k) {
    const double share = static_cast<double>(k) / kPoints, code = kBrightest * max_code * share * share;
    const double level = response.exposure(channel, code) / full_well;
    const double expected = expected_code(level, noise.stddev(level), thresholds);
    // So deep in the noise that codes say nothing of the light: the table starts above it.
    if (!table.expected.empty() && expected <= table.expected.back()) {
      table = {};
    }
    table.expected.push_back(expected);
    table.code.push_back(code);
  }
  return table;
}

}  // namespace

Observations without_noise_bias(const Observations& observed, const Response& response, const Noise& noise) {
  Observations corrected = observed;
  const double max_code = std::ldexp(1.0, observed.bits) - 1;
  for (std::size_t c = 0; c < 3; ++c) {
    if (observed.codes[c].rows() == 0 || observed.black_level[c] > 0) continue;
    const BiasTable table = bias_table(response, static_cast<int>(c), noise[c]);
    for (double& code : corrected.codes[c].reshaped()) {
      if (!(code < kBrightest * max_code)) continue;  // and not NaN
      // Below what the table starts with there is only noise.
      code = code < table.expected.front() ? NAN : table.without_bias(code);
    }
    corrected.codes[c] = rows_seen_twice(corrected.codes[c], corrected.ln_exposure);
  }
  return corrected;
}

}  // namespace hdr
