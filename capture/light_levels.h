#pragma once
// The light of a scene, as far as probing frames show it: what a plan is made from.
#include <vector>

#include "capture/appearance.h"
#include "capture/brightness.h"

namespace hdr {

struct Probe {
  double total = 1;  ///< seconds times gain, verified
  const Appearance* appearance = nullptr;
};

/// Logs of exposure that a shot can tell, in the units of BrightnessModel::ln_exposure: light L shows in a shot of
/// total exposure H when floor <= L + ln H <= ceiling.
struct Window {
  double floor = 0, ceiling = 0;
};
Window window_of(const BrightnessModel& model);

/// Samples of all colours in equal shares, dark to bright, as ln light. Those that are black in the longest probe, or
/// clipped in the shortest one, are known by that only: they are at the bound, and counted.
struct LightLevels {
  std::vector<double> ln_light;
  double black = 0, clipped = 0;  ///< shares
};

inline constexpr int kLightLevels = 8000;

/// Each share is read from the longest probe that does not clip it. Throws Error without probes.
LightLevels light_levels(std::vector<Probe> probes, const BrightnessModel& model);

}  // namespace hdr
