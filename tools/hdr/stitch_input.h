#pragma once
// What `stitch` reads: radiance maps, photographs, and folders of shots that are merged first.
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/radiance.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

struct StitchInput {
  std::string name;
  RadianceMap map;
  double ceiling = std::numeric_limits<double>::infinity();  ///< of a photograph: what reaches it is clipped
  std::optional<double> fov_degrees;                         ///< what EXIF says
};

struct StitchReading {
  std::string response = "auto";  ///< of photographs and brackets; auto: sRGB, and for brackets fitted to the first
  bool uncertainty = false;       ///< brackets are merged with it
};

/// A folder alone stands for what is in it: photographs, or folders of shots. Other folders are brackets, which are
/// merged with the response and the unit of the first, so that all have one scale.
std::vector<StitchInput> read_stitch_inputs(Run& run, const std::vector<std::string>& photos,
                                            const StitchReading& reading);

}  // namespace hdr::tools
