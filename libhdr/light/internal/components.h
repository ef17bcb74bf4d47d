#pragma once
// Connected regions of a lat-long's cells, on the sphere: the seam is no edge, and all cells around a pole touch.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr {

/// The cells of each region where `inside` is not 0, regions in the order of their first cells, neighbours by eight.
std::vector<std::vector<std::int32_t>> connected_components(const std::vector<std::uint8_t>& inside, Size size);

}  // namespace hdr
