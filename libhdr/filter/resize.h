#pragma once
// Another number of pixels for the same picture.
#include "libhdr/core/image.h"

namespace hdr {

/// Means over the covered area when it shrinks, bilinear when it grows; each axis for itself.
Image<float> resize(View<const float> source, Size size);

}  // namespace hdr
