#pragma once
// What a plan is compared with: a search that knows the scene, the response and nothing of the planner.
#include <algorithm>
#include <bitset>
#include <cmath>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr::test {

/// Levels of full well that a shot tells: from `floor` to `ceiling`.
struct Levels {
  double floor = 0, ceiling = 1;
};

/// A sample is light * exposure of full well. Samples in rising order; those that no exposure from `shortest` to
/// `longest` shows are left out, and .1 % of all at each end.
inline std::vector<double> samples_to_show(View<const float> scene, double sensitivity, const Levels& levels,
                                           double shortest, double longest, double lost = 0.001) {
  std::vector<double> light;
  for (int y = 0; y < scene.height(); ++y) {
    for (int k = 0; k < scene.width() * scene.channels(); ++k) light.push_back(scene.row(y)[k] * sensitivity);
  }
  std::sort(light.begin(), light.end());
  const auto tail = static_cast<std::ptrdiff_t>(lost * static_cast<double>(light.size()));
  light = std::vector<double>(light.begin() + tail, light.end() - tail);
  std::erase_if(light, [&](double x) { return x * longest < levels.floor || x * shortest > levels.ceiling; });
  return light;
}

/// Share of the samples that no exposure shows.
inline double share_missed(const std::vector<double>& light, const std::vector<double>& exposures,
                           const Levels& levels) {
  const auto missed = std::count_if(light.begin(), light.end(), [&](double x) {
    return std::none_of(exposures.begin(), exposures.end(),
                        [&](double h) { return x * h >= levels.floor && x * h <= levels.ceiling; });
  });
  return light.empty() ? 0 : static_cast<double>(missed) / static_cast<double>(light.size());
}

/// The fewest of `candidates` that show all samples, by trying all sets of one, two and three of them; 4 when there is
/// none so small. Samples are taken at 512 quantiles.
inline int fewest_by_trying(const std::vector<double>& light, const std::vector<double>& candidates,
                            const Levels& levels) {
  constexpr std::size_t kQuantiles = 512;
  using Shown = std::bitset<kQuantiles>;
  if (light.empty()) return 0;
  std::vector<Shown> shown;
  for (const double h : candidates) {
    Shown bits;
    for (std::size_t q = 0; q < kQuantiles; ++q) {
      const double x = light[q * (light.size() - 1) / (kQuantiles - 1)];
      bits[q] = x * h >= levels.floor && x * h <= levels.ceiling;
    }
    shown.push_back(bits);
  }
  int fewest = 4;
  for (std::size_t a = 0; a < shown.size(); ++a) {
    if (shown[a].all()) return 1;
    for (std::size_t b = a + 1; b < shown.size(); ++b) {
      const Shown two = shown[a] | shown[b];
      if (two.all()) fewest = std::min(fewest, 2);
      if (fewest <= 3) continue;
      for (std::size_t c = b + 1; c < shown.size() && fewest > 3; ++c) {
        if ((two | shown[c]).all()) fewest = 3;
      }
    }
  }
  return fewest;
}

/// The same for any number: the longest run of samples, from the darkest on, that n exposures can show.
inline int fewest_by_reach(const std::vector<double>& light, const std::vector<double>& candidates,
                           const Levels& levels) {
  std::size_t reached = 0;
  for (int n = 0; n < 64; ++n) {
    if (reached == light.size()) return n;
    std::size_t furthest = reached;
    for (const double h : candidates) {
      const auto first = std::lower_bound(light.begin(), light.end(), levels.floor / h) - light.begin();
      const auto end = std::upper_bound(light.begin(), light.end(), levels.ceiling / h) - light.begin();
      if (static_cast<std::size_t>(first) <= reached) furthest = std::max(furthest, static_cast<std::size_t>(end));
    }
    if (furthest == reached) ++furthest;  // between two exposures of the device: nobody shows it
    reached = furthest;
  }
  return 64;
}

}  // namespace hdr::test
