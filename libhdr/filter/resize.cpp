#include "libhdr/filter/resize.h"

#include <opencv2/imgproc.hpp>

#include "libhdr/core/internal/opencv.h"

namespace hdr {

Image<float> resize(View<const float> source, Size size) {
  HDR_ASSERT(!source.empty() && size.width > 0 && size.height > 0);
  // One axis at a time, since OpenCV's INTER_AREA is an area mean only where it shrinks.
  const auto method = [](int from, int to) { return to < from ? cv::INTER_AREA : cv::INTER_LINEAR; };
  Image<float> wide(size.width, source.height(), source.channels());
  cv::Mat wide_mat = internal::mat_from_view(wide.view());
  cv::resize(internal::mat_from_view(source), wide_mat, wide_mat.size(), 0, 0, method(source.width(), size.width));
  Image<float> out(size, source.channels());
  cv::Mat out_mat = internal::mat_from_view(out.view());
  cv::resize(wide_mat, out_mat, out_mat.size(), 0, 0, method(source.height(), size.height));
  return out;
}

}  // namespace hdr
