#pragma once
// Prefiltered light by way of frequencies [Ramamoorthi02]: a lobe that is broad holds few bands, and the probe blurred
// by it is those bands of the probe times the lobe's. Sharp lobes are prefilter.h's.
#include "libhdr/light/prefilter.h"
#include "libhdr/light/sh.h"

namespace hdr {

class FrequencyPrefilter {
 public:
  /// A lat-long with three channels, finite and non-negative.
  explicit FrequencyPrefilter(View<const float> latlong);

  struct Level {
    Sh sh;             ///< radiance of the blurred probe; ripples below 0 by no more than the bound
    double bound = 0;  ///< on the error, over all directions, of the level's largest value, the worst channel
    bool met = false;  ///< bound <= error
  };
  /// The lowest degree that the bands of the probe and of the lobe allow within `error` (> 0); the highest there is,
  /// kMaxShDegree, where none is. roughness > 0.
  Level level(double roughness, Lobe lobe, double error) const;

 private:
  Sh light_;
  Rgb energy_beyond_ = Rgb::Zero();  ///< integral of L^2 less what light_ has of it
  Rgb flux_ = Rgb::Zero();           ///< integral of L
};

}  // namespace hdr
