#include "tests/bench/rivals/opencv_blur.h"

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/internal/opencv.h"

namespace hdr::bench {

void opencv_gaussian(View<const float> image, View<float> blurred, double sigma, int threads) {
  cv::setNumThreads(threads);
  cv::Mat out(blurred.height(), blurred.width(), CV_32FC3, blurred.data(),
              static_cast<std::size_t>(blurred.stride()) * sizeof(float));
  cv::GaussianBlur(internal::mat_from_view(image), out, {}, sigma, sigma, cv::BORDER_REFLECT);
}

}  // namespace hdr::bench
