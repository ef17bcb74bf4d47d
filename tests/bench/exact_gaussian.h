#pragma once
#include "libhdr/core/image.h"

namespace hdr::bench {

/// The sampled Gaussian of one pixel, in double; the picture mirrored at its borders.
double exact_gaussian(const Image<float>& map, int x, int y, int c, double sigma);

/// The largest relative error of twelve pixels.
double worst_gaussian_error(const Image<float>& map, const Image<float>& blurred, double sigma);

}  // namespace hdr::bench
