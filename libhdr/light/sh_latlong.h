#pragma once
#include "libhdr/light/sh.h"

namespace hdr {

/// Radiance of an expansion at the pixel centres of a lat-long, row by row: what it has below zero stays.
Image<float> latlong_of(const Sh& sh, Size size);

}  // namespace hdr
