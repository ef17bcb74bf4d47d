#include "tests/bench/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hdr::bench {
namespace {

float quantile(std::vector<float>& values, double q) {
  if (values.empty()) return std::numeric_limits<float>::quiet_NaN();
  const auto k = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), k, values.end());
  return *k;
}

/// Of one channel.
struct Samples {
  std::vector<float> well;       ///< log2 of map over truth
  std::vector<float> saturated;  ///< log2 of map over the level that saturates the shortest shot
};

Samples samples_of(View<const float> map, const Truth& truth, int channel, int step) {
  const double shortest = *std::min_element(truth.seconds.begin(), truth.seconds.end());
  const auto saturation = static_cast<float>(1 / (truth.k * shortest));
  Samples samples;
  for (int y = 0; y < map.height(); y += step) {
    for (int x = 0; x < map.width(); x += step) {
      const float value = map(x, y, channel), light = truth.radiance(x, y, channel);
      if (!(value > 0 && std::isfinite(value))) continue;
      const double per_second = light * truth.k;
      const bool well = std::any_of(truth.seconds.begin(), truth.seconds.end(),
                                    [&](double t) { return per_second * t >= 0.02 && per_second * t <= 0.90; });
      if (well) samples.well.push_back(std::log2(value / light));
      if (per_second * shortest > 1.02) samples.saturated.push_back(std::log2(value / saturation));
    }
  }
  return samples;
}

}  // namespace

MapScore score_map(View<const float> map, const Truth& truth, int step) {
  HDR_ASSERT(map.size() == truth.radiance.size());
  MapScore score;
  for (int y = 0; y < map.height(); ++y) {
    for (int k = 0; k < 3 * map.width(); ++k) score.bad += !(map.row(y)[k] >= 0 && std::isfinite(map.row(y)[k]));
  }
  std::vector<float> errors, caps;
  for (int c = 0; c < 3; ++c) {
    Samples samples = samples_of(map, truth, c, step);
    const float scale = quantile(samples.well, 0.5);
    for (const float ratio : samples.well) errors.push_back(std::abs(ratio - scale));
    for (const float ratio : samples.saturated) caps.push_back(ratio - scale);
  }
  score.median = quantile(errors, 0.5);
  score.p99 = quantile(errors, 0.99);
  score.cap = std::exp2(quantile(caps, 0.5));
  return score;
}

double response_rms(const Response& fitted, const Response& truth) {
  double mean = 0;
  for (int c = 0; c < 3; ++c) {
    double sum = 0, squares = 0, count = 0;
    for (int code = 5; code <= 250; ++code) {
      const double e = fitted.ln_exposure(c, code / 255.0 * ((1 << fitted.bits) - 1)) -
                       truth.ln_exposure(c, code / 255.0 * ((1 << truth.bits) - 1));
      sum += e;
      squares += e * e;
      ++count;
    }
    mean += std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count))) / 3;
  }
  return mean;
}

}  // namespace hdr::bench
