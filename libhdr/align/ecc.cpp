// Enhanced correlation coefficient [Evangelidis08], OpenCV's, masked.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include "libhdr/align/internal/pair.h"
#include "libhdr/core/internal/opencv.h"

namespace hdr::internal {
namespace {

/// Pixels of b that are usable, and that `start` takes to a usable pixel of a: findTransformECC has one mask only.
cv::Mat common_mask(const LogPicture& a, const LogPicture& b, const Vec2& start) {
  const int dx = static_cast<int>(std::lround(start.x())), dy = static_cast<int>(std::lround(start.y()));
  cv::Mat mask = cv::Mat::zeros(b.ln.height(), b.ln.width(), CV_8U);
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      const int u = x - dx, v = y - dy;
      const bool inside = u >= 0 && v >= 0 && u < a.ln.width() && v < a.ln.height();
      if (inside && b.usable(x, y) && a.usable(u, v)) mask.at<std::uint8_t>(y, x) = 255;
    }
  }
  return mask;
}

}  // namespace

PairMotion ecc_shift(const Pyramid& a, const Pyramid& b, const Vec2& start) {
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-6);
  constexpr int kNoBlur = 1;  // the pictures are smoothed already, with care for their unusable pixels
  Vec2 shift = start;
  bool converged = false;
  for (std::size_t level = std::min(a.levels.size(), b.levels.size()); level-- > 0;) {
    const LogPicture &pa = a.levels[level], &pb = b.levels[level];
    cv::Mat warp = (cv::Mat_<float>(2, 3) << 1, 0, shift.x() / pa.cell, 0, 1, shift.y() / pa.cell);
    try {
      cv::findTransformECC(mat_from_view(pa.ln.view()), mat_from_view(pb.ln.view()), warp, cv::MOTION_TRANSLATION,
                           criteria, common_mask(pa, pb, shift / pa.cell), kNoBlur);
      shift = Vec2(warp.at<float>(0, 2), warp.at<float>(1, 2)) * pa.cell;
      converged = true;
    } catch (const cv::Exception&) {
      converged = false;  // a coarse level may have too little in common; the finest must not
    }
  }
  return converged ? assess_shift(a, b, shift) : failed("the correlation did not converge");
}

}  // namespace hdr::internal
