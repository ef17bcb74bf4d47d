#pragma once
// cv::Mat headers over our memory: nothing is copied, the Mat must not outlive the View. Include from .cpp only.
#include <opencv2/core/mat.hpp>

#include "libhdr/core/image.h"

namespace hdr::internal {

template <class T>
cv::Mat mat_from_view(View<T> view) {
  using Sample = std::remove_const_t<T>;
  const int type = CV_MAKETYPE(cv::DataType<Sample>::depth, view.channels());
  auto* data = const_cast<Sample*>(view.data());  // cv::Mat has no const form; callers keep const views read-only
  return cv::Mat(view.height(), view.width(), type, data, static_cast<std::size_t>(view.stride()) * sizeof(Sample));
}

}  // namespace hdr::internal
