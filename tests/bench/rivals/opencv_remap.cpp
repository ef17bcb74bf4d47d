#include "tests/bench/rivals/opencv_remap.h"

#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/parallel.h"

namespace hdr::bench {

struct OpenCvRemap::Maps {
  cv::Mat whole, fraction;
};

OpenCvRemap::OpenCvRemap(Size output, const std::function<Vec2(int x, int y)>& source_from_output)
    : maps_(std::make_unique<Maps>()) {
  cv::Mat x(output.height, output.width, CV_32F), y(output.height, output.width, CV_32F);
  for_rows(output.height, 16, [&](int first, int last) {
    for (int j = first; j < last; ++j) {
      for (int i = 0; i < output.width; ++i) {
        const Vec2 px = source_from_output(i, j);
        const bool somewhere = px.x() == px.x();
        x.at<float>(j, i) = somewhere ? static_cast<float>(px.x() - 0.5) : -100;  // its pixel centres are at integers
        y.at<float>(j, i) = somewhere ? static_cast<float>(px.y() - 0.5) : -100;
      }
    }
  });
  cv::convertMaps(x, y, maps_->whole, maps_->fraction, CV_16SC2);
}

OpenCvRemap::~OpenCvRemap() = default;

void OpenCvRemap::run(View<const float> source, View<float> output, int threads, RemapKernel kernel) const {
  constexpr int kCodes[] = {cv::INTER_NEAREST, cv::INTER_LINEAR, cv::INTER_CUBIC, cv::INTER_LANCZOS4};
  cv::setNumThreads(threads);
  const cv::Mat from(source.height(), source.width(), CV_32FC3, const_cast<float*>(source.data()),
                     static_cast<std::size_t>(source.stride()) * sizeof(float));
  cv::Mat to(output.height(), output.width(), CV_32FC3, output.data(),
             static_cast<std::size_t>(output.stride()) * sizeof(float));
  cv::remap(from, to, maps_->whole, maps_->fraction, kCodes[static_cast<int>(kernel)], cv::BORDER_REPLICATE);
}

}  // namespace hdr::bench
