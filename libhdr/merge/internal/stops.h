#pragma once
#include "libhdr/core/image.h"

namespace hdr {

/// log2 of the 99.9 % over the 0.1 % quantile of positive luminance, to 1/100 stop; 0 when nothing is positive.
double stops_of_luminance(View<const float> rgb);

}  // namespace hdr
