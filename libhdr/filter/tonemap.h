#pragma once
// Linear light -> 8-bit sRGB, for looking.
#include <cstdint>

#include "libhdr/core/image.h"

namespace hdr {

/// Stops that bring the picture's log-average luminance to 18 % grey [Reinhard02 eq. 1]; 0 for a black picture.
double metered_stops(View<const float> rgb);

/// Exposure in stops, then a shoulder that keeps highlights apart (extended Reinhard, white at the picture's 99.9 %
/// luminance), sRGB, 8 bits. `alpha` (may be empty) becomes the fourth channel.
Image<std::uint8_t> tonemap(View<const float> rgb, double stops, View<const float> alpha = {});

}  // namespace hdr
