#pragma once
#include "libhdr/core/image.h"

namespace hdr::internal {

/// Whether two pictures are one, to the bit: a file that was given twice.
bool same_pixels(View<const float> a, View<const float> b);

}  // namespace hdr::internal
