#pragma once
// What parts of a lat-long contribute to the irradiance of normals.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// Cells of a lat-long, y * width + x.
using Region = std::vector<std::int32_t>;

/// A row a normal, a column a region, and a last one for all pixels of none. Pixels count at their centres.
std::vector<std::vector<Rgb>> region_irradiance(View<const float> latlong, const std::vector<Region>& regions,
                                                const std::vector<Vec3>& normals);

}  // namespace hdr
