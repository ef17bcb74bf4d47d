#pragma once
// Pixels of a lat-long that directions meet, many at once.
#include <cstdint>
#include <span>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// Where the pixel that each direction meets begins, in samples from the map's first. Directions need not be of unit
/// length. Agrees with latlong_from_dir() but within 1e-7 of the map's width or height of a pixel's border. Arrays do
/// not overlap.
void latlong_offsets(const float* dir_x, const float* dir_y, const float* dir_z, int count, View<const float> map,
                     std::int32_t* offsets);

/// Between pixel centres of a map with three channels, for what is looked at, as Environment::smooth_radiance().
Rgbf smooth_pixel(View<const float> map, const Vec3f& dir);
/// As many `pixels` as `dirs`.
void smooth_pixels(View<const float> map, std::span<const Vec3f> dirs, std::span<Rgbf> pixels);

}  // namespace hdr
