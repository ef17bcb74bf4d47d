#pragma once
#include "libhdr/core/image.h"

namespace hdr::internal {

/// The luminance that a share of the pixels does not exceed; 0 without pixels.
double luminance_quantile(View<const float> rgb, double share);

}  // namespace hdr::internal
