#pragma once
// Which exposures a scene needs: a pure function of what probing frames show and of what the device can do.
#include <optional>
#include <string>
#include <vector>

#include "capture/camera.h"
#include "capture/light_levels.h"

namespace hdr {

/// What the person asked for: times, a grid, or neither: then exposures are found by probing the scene.
struct BracketRequest {
  struct Grid {
    double stops = 2;  ///< between shots
    int count = 5;
  };
  std::vector<double> times;    ///< seconds, at the device's least gain
  std::optional<Grid> grid;     ///< about the exposure at which the scene's median is 18 % of the largest code's light
  bool response_known = false;  ///< else an automatic plan has one shot off the grid of the others
  std::optional<double>
      mains_hz;  ///< 50 or 60: lamps flicker at twice that, and exposures are multiples of that period
};

struct PlannedShot {
  ExposureSetting setting;
  std::string reason;  ///< "clips 0.04 % of the samples; 31 % are in no shorter one"
};

/// Shots in rising order of exposure; given times in their own.
struct Plan {
  std::vector<PlannedShot> shots;
  std::vector<std::string>
      notes;  ///< e.g. "0.4 % of the samples stay in the noise: the device exposes for 0.5 s at most"
  bool bright_end_lost = false;  ///< more than 0.1 % of the samples clip in the shortest shot the device can take
  bool dark_end_lost = false;    ///< more than 0.1 % are noise in the longest one
};

/// Samples that may be lost at each end, and between shots.
inline constexpr double kLostShare = 0.001;

/// The setting nearest to this product of seconds and gain, at most it (`down`) or at least it, that the device has and
/// that lamps allow: gain only where the time is at its limit, and times that are longer than a flicker period are
/// multiples of it. At the device's ends, the end.
ExposureSetting setting_at_most(double total, const Capabilities& limits, std::optional<double> mains_hz = {});
ExposureSetting setting_at_least(double total, const Capabilities& limits, std::optional<double> mains_hz = {});
ExposureSetting setting_near(double total, const Capabilities& limits, std::optional<double> mains_hz = {});

/// The exposure to probe next: three stops beyond the probes, on the side where light is missing and the device can.
/// nullopt when the ends of the scene, or of the device, are known.
std::optional<ExposureSetting> next_probe(const std::vector<Probe>& probes, const BrightnessModel& model,
                                          const Capabilities& limits, std::optional<double> mains_hz = {});

/// As few shots as show every sample between noise and clipping in one of them, kLostShare at each end excepted. Shots
/// stand in the middle of where they may, at the exposure of a probe (it is there already) where that is as good; with
/// margins for the error of what was seen. With an unknown response one more shot, off the grid of the others.
Plan plan_auto(const LightLevels& light, const Window& window, const std::vector<Probe>& probes,
               const Capabilities& limits, const BracketRequest& request);

/// `count` shots `stops` apart about the scene's middle. What the device cannot reach is left out, with a note.
Plan plan_grid(const LightLevels& light, const Capabilities& limits, const BracketRequest& request);

/// The given times, snapped; those that the device cannot reach are its limits, with a note. So have those that lamps
/// make flicker, which are kept.
Plan plan_times(const Capabilities& limits, const BracketRequest& request);

}  // namespace hdr
