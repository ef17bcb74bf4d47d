#pragma once
// The strata of lights drawn over their map, to look at.
#include <cstdint>

#include "libhdr/core/image.h"
#include "libhdr/light/lights.h"

namespace hdr::tools {

/// 8-bit sRGB: the map tone mapped, edges between strata in white, lights as discs whose area grows with their share.
Image<std::uint8_t> strata_picture(View<const float> latlong, const Lights& lights);

}  // namespace hdr::tools
