#pragma once
// How a camera ray's place in the picture is weighed: by drawing places with the filter's density, every ray counts the
// same (filter importance sampling [Ernst06]), and rays of different pixels stay independent.
#include "libhdr/core/vec.h"
#include "libhdr/render/render.h"

namespace hdr {

/// Where in the picture, from the pixel's corner, a ray goes that u in [0,1)^2 draws: anywhere in the pixel (kBox), or
/// with [Harris78]'s four-term window, 1.5 pixels to each side of its middle (kBlackmanHarris).
Vec2 filtered_place(FilmFilter filter, const Vec2& u);

}  // namespace hdr
