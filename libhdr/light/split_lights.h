#pragma once
// A probe in two: its compact lights, and a soft rest that neither surprises a few hundred directions nor rings.
#include "libhdr/core/image.h"

namespace hdr {

struct SplitLights {
  Image<float> compact;  ///< what suns and lamps have above `level`; black elsewhere
  Image<float> soft;     ///< the rest; compact + soft is the map
  double level = 0;      ///< luminance
  double share = 0;      ///< of the map's light that is compact
};

/// Of a lat-long with three channels, finite and non-negative. `level` is where it is `contrast` times the mean
/// luminance that the soft part has over the sphere. Colours are kept: both parts of a pixel have its own.
SplitLights split_lights(View<const float> latlong, double contrast = 8);

}  // namespace hdr
