#include "capture/light_levels.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

/// The codes that shares (k + .5) / count are below, in one pass.
std::vector<double> quantiles_of(const Appearance& appearance, int count) {
  std::size_t codes = 0;
  double total = 0;
  for (const CodeHistogram& colour : appearance.colours) {
    codes = std::max(codes, colour.counts.size());
    total += static_cast<double>(colour.total);
  }
  std::vector<double> quantiles;
  double below = 0;
  for (std::size_t code = 0; code < codes; ++code) {
    double here = 0;
    for (const CodeHistogram& colour : appearance.colours) {
      if (code < colour.counts.size()) here += colour.counts[code];
    }
    while (static_cast<int>(quantiles.size()) < count) {
      const double wanted = (static_cast<double>(quantiles.size()) + 0.5) / count * total;
      if (below + here < wanted) break;
      quantiles.push_back(static_cast<double>(code) - 0.5 + (here > 0 ? (wanted - below) / here : 0.5));
    }
    below += here;
  }
  quantiles.resize(static_cast<std::size_t>(count), static_cast<double>(codes) - 0.5);
  return quantiles;
}

}  // namespace

Window window_of(const BrightnessModel& model) {
  return {model.ln_exposure(model.usable().floor), model.ln_exposure(model.usable().ceiling)};
}

LightLevels light_levels(std::vector<Probe> probes, const BrightnessModel& model) {
  if (probes.empty()) throw Error("no frame shows the scene's light; take one first");
  std::stable_sort(probes.begin(), probes.end(), [](const Probe& a, const Probe& b) { return a.total > b.total; });
  std::vector<std::vector<double>> codes;
  for (const Probe& probe : probes) codes.push_back(quantiles_of(*probe.appearance, kLightLevels));
  LightLevels levels;
  for (std::size_t k = 0; k < static_cast<std::size_t>(kLightLevels); ++k) {
    std::size_t longest = 0;
    while (longest + 1 < probes.size() && codes[longest][k] > model.usable().ceiling) ++longest;
    const double code = codes[longest][k];
    if (longest == 0 && code < model.usable().floor) levels.black += 1.0 / kLightLevels;
    if (code > model.usable().ceiling) levels.clipped += 1.0 / kLightLevels;
    const double light = model.ln_exposure(std::clamp(code, model.usable().black + 0.5, model.usable().white)) -
                         std::log(probes[longest].total);
    // What two probes say at their seam may differ by their noise; shares stay in order.
    levels.ln_light.push_back(levels.ln_light.empty() ? light : std::max(light, levels.ln_light.back()));
  }
  return levels;
}

}  // namespace hdr
