#pragma once
// Which exposures a scene needs.
#include <optional>
#include <string>
#include <vector>

#include "capture/camera.h"

namespace hdr {

/// What the person asked for: times, a grid, or neither: then exposures are found by probing the scene.
struct BracketRequest {
  struct Grid {
    double stops = 2;  ///< between shots
    int count = 5;
  };
  std::vector<double> times;       ///< seconds
  std::optional<Grid> grid;        ///< about the exposure that suits the scene's middle
  bool response_known = false;     ///< else one exposure of an automatic plan stands off the grid
  std::optional<double> mains_hz;  ///< 50 or 60: lamps flicker at twice that, exposures are multiples of its period
};

struct PlannedShot {
  ExposureSetting setting;
  std::string reason;  ///< "the brightest 1.2 % clip in the next longer one"
};

/// Shots in rising order of exposure.
struct Plan {
  std::vector<PlannedShot> shots;
  std::vector<std::string> notes;  ///< e.g. "0.4 % of the pixels stay black: the device exposes for 0.5 s at most"
  bool bright_end_lost = false;    ///< more than 0.1 % of the samples clip in the shortest shot
  bool dark_end_lost = false;      ///< more than 0.1 % are noise in the longest one
};

}  // namespace hdr
