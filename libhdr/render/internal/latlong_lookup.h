#pragma once
// Pixels of a lat-long that directions meet, many at once.
#include <cstdint>

#include "libhdr/core/image.h"

namespace hdr {

/// Where the pixel that each direction meets begins, in samples from the map's first. Directions need not be of unit
/// length. Agrees with latlong_from_dir() but within 1e-7 of the map's width or height of a pixel's border. Arrays do
/// not overlap.
void latlong_offsets(const float* dir_x, const float* dir_y, const float* dir_z, int count, View<const float> map,
                     std::int32_t* offsets);

}  // namespace hdr
