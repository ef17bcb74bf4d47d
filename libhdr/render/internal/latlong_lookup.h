#pragma once
// Pixels of a lat-long that directions meet, many at once.
#include <cstdint>

#include "libhdr/core/image.h"

namespace hdr {

/// Index (y * width + x) of the pixel that each direction meets. Directions need not be of unit length. Agrees with
/// latlong_from_dir() but within 1e-7 of the map's width or height of a pixel's border. The arrays do not overlap.
void latlong_pixels(const float* dir_x, const float* dir_y, const float* dir_z, int count, Size size,
                    std::int32_t* pixels);

}  // namespace hdr
