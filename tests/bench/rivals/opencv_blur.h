#pragma once
#include "libhdr/core/image.h"

namespace hdr::bench {

/// cv::GaussianBlur, with a kernel as long as it chooses for floats, mirrored at the borders.
void opencv_gaussian(View<const float> image, View<float> blurred, double sigma, int threads);

}  // namespace hdr::bench
