#include "tests/bench/rivals/opencv_align_mtb.h"

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include "libhdr/core/error.h"

namespace hdr::bench {
namespace {

cv::Mat grey_of(const Photo& photo) {
  const auto* codes = std::get_if<Image<std::uint8_t>>(&photo.codes);
  HDR_ASSERT(codes != nullptr);
  const cv::Mat rgb(codes->height(), codes->width(), CV_8UC3, const_cast<std::uint8_t*>(codes->row(0)),
                    static_cast<std::size_t>(codes->stride()));
  cv::Mat grey;
  cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
  return grey;
}

class OpenCvAlignMtb : public AlignRival {
 public:
  std::string name() const override { return "OpenCV AlignMTB"; }

  std::vector<Mat3> run(const Bracket& bracket, int threads) const override {
    cv::setNumThreads(threads);
    const cv::Ptr<cv::AlignMTB> align = cv::createAlignMTB(6, 4, false);
    const cv::Mat middle = grey_of(bracket.shots[(bracket.shots.size() - 1) / 2]);
    std::vector<Mat3> motions;
    for (const Photo& photo : bracket.shots) {
      const cv::Point shift = align->calculateShift(middle, grey_of(photo));
      Mat3 motion = Mat3::Identity();
      motion.topRightCorner<2, 1>() = Vec2(shift.x, shift.y);
      motions.push_back(motion);
    }
    return motions;
  }
};

}  // namespace

std::unique_ptr<AlignRival> opencv_align_mtb() {
  return std::make_unique<OpenCvAlignMtb>();
}

}  // namespace hdr::bench
