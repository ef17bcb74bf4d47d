#pragma once
// Corners that a lens leaves darker.
#include "libhdr/core/radiance.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// A lens passes 1 + k1 r^2 + k2 r^4 + k3 r^6 of what it passes in the middle, r in half-diagonals of the frame from
/// its centre, as lensfun's model `pa` and Hugin have it.
struct Vignetting {
  double k1 = 0, k2 = 0, k3 = 0;
  double at(double r2) const { return 1 + r2 * (k1 + r2 * (k2 + r2 * k3)); }
};

/// Divides it out of the radiance and of its standard deviation. Error where it leaves no light within the frame.
void divide_vignetting(RadianceMap& map, const Vignetting& vignetting);

}  // namespace hdr
