#pragma once
#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// Irradiance of a horizontal surface that faces up (+Y) under a lat-long, what a lux meter lying there reads: the
/// integral of L cos over the upper hemisphere, over each pixel's exact cell, a pixel being a constant; sums are in
/// double.
Rgb horizontal_irradiance(View<const float> latlong);

}  // namespace hdr
