#pragma once
// Linear light. Values are relative radiance unless white_luminance says how many cd/m^2 the colour (1,1,1) has.
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr {

/// CIE xy of the primaries and of white: Rec. 709 / sRGB unless a file says otherwise.
struct Chromaticities {
  float red[2] = {0.64f, 0.33f};
  float green[2] = {0.30f, 0.60f};
  float blue[2] = {0.15f, 0.06f};
  float white[2] = {0.3127f, 0.3290f};
};

struct RadianceMap {
  Image<float> rgb;     ///< three channels, linear
  Image<float> alpha;   ///< one channel, coverage 0..1; empty when the picture has none
  Image<float> stddev;  ///< standard deviation of rgb, same shape; empty when it was not asked for
  Chromaticities chromaticities;
  std::optional<double> white_luminance;  ///< cd/m^2 of (1,1,1)
  std::string projection;  ///< hdr:projection, e.g. "latlong" (probe/projection.h); empty: a plain picture

  Size size() const { return rgb.size(); }
};

/// How a picture came to be, written into every EXR: version, options that change pixels, inputs without folders. No
/// clock time, no thread count: the same work gives the same bytes. Keys are written as "hdr:KEY".
struct Provenance {
  std::vector<std::pair<std::string, std::string>> entries;

  void add(std::string key, std::string value) { entries.emplace_back(std::move(key), std::move(value)); }
};

}  // namespace hdr
