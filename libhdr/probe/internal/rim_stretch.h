#pragma once
// Is what a circle holds a mirrored sphere's reflection, or a disc: a lamp, a plate, a wheel, a window?
//
// At r of the radius a sphere shows the direction at 2 asin(r) from its middle: what is small and round in the scene is
// 1 / (1 - r^2) times as long across the radius as along it. A disc's own pattern is as often one as the other; lamps,
// plates and matt balls have rings, the same all around, which count for nothing here; spokes lie the other way.
#include "libhdr/core/image.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

/// How much of that stretching a picture of luminance (above 0) has inside a circle: a sphere's is about 1, that of a
/// pattern without direction 0, of spokes below; 0 where there is no pattern. `noise` is the standard deviation of a
/// pixel as a share of its value.
double rim_stretch(View<const float> luminance, const Disc& circle, double noise);

}  // namespace hdr::internal
