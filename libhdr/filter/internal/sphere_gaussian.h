#pragma once
#include "libhdr/core/image.h"

namespace hdr::internal {

/// gaussian_blur on Surface::kLatLong, `sigma` > 0 in pixels of the equator.
Image<float> sphere_gaussian(View<const float> latlong, double sigma);

}  // namespace hdr::internal
