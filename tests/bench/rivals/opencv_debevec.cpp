#include "tests/bench/rivals/opencv_debevec.h"

#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/photo.hpp>

#include "libhdr/core/error.h"

namespace hdr::bench {
namespace {

/// A view of the codes; OpenCV's BGR order does not matter to what treats channels alike.
cv::Mat mat_of(const Photo& photo) {
  const auto* codes = std::get_if<Image<std::uint8_t>>(&photo.codes);
  HDR_ASSERT(codes != nullptr);
  return {codes->height(), codes->width(), CV_8UC3, const_cast<std::uint8_t*>(codes->row(0)),
          static_cast<std::size_t>(codes->stride())};
}

class OpenCvDebevec : public Rival {
 public:
  std::string name() const override { return "OpenCV Debevec"; }

  RivalAnswer run(const Bracket& bracket, int threads) const override {
    cv::setNumThreads(threads);
    std::vector<cv::Mat> shots;
    std::vector<float> seconds;
    for (const Photo& photo : bracket.shots) {
      shots.push_back(mat_of(photo));
      seconds.push_back(static_cast<float>(*photo.exposure.seconds));
    }
    cv::Mat exposures;  // 256 x 1 x 3: f^-1(code)
    cv::createCalibrateDebevec(70, 10)->process(shots, exposures, seconds);
    const auto map = std::make_shared<cv::Mat>();
    cv::createMergeDebevec()->process(shots, *map, seconds, exposures);

    RivalAnswer answer;
    answer.map = {map->ptr<float>(), map->cols, map->rows, 3, static_cast<std::ptrdiff_t>(map->step1())};
    answer.owner = map;
    for (int c = 0; c < 3; ++c) {
      for (int code = 0; code < 256; ++code) {
        answer.response.g[static_cast<std::size_t>(c)].push_back(std::log(exposures.at<cv::Vec3f>(code)[c]));
      }
    }
    return answer;
  }
};

}  // namespace

std::unique_ptr<Rival> opencv_debevec() {
  return std::make_unique<OpenCvDebevec>();
}

}  // namespace hdr::bench
