#pragma once
// A sphere that says which way round it is.
#include "libhdr/core/image.h"

namespace hdr {

/// A lat-long of width x width/2 pixels, width >= 64. Its colour is the direction, R G B = 1/2 + X Y Z / 2 (linear),
/// with dark lines every 15 degrees, the horizon white, and a white label on each axis (+X -X +Y -Y +Z -Z) and every 30
/// degrees around the horizon (the azimuth from +Z towards +X). Labels read from left to right as seen from inside, +Y
/// up (those of +Y and -Y: with +Z at the bottom and at the top), so that a mirrored or turned picture shows.
Image<float> test_chart(int width);

}  // namespace hdr
