// Features: ORB [Rublee11] on exposure-normalised pictures, and the shift on which most matches agree.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "libhdr/align/internal/pair.h"

namespace hdr::internal {
namespace {

struct Features {
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
};

/// ln radiance from `low` to `high` as 8-bit grey, the same for both shots; only usable pixels may hold a feature.
Features features_of(const LogPicture& picture, float low, float high) {
  cv::Mat grey(picture.ln.height(), picture.ln.width(), CV_8U), mask(grey.size(), CV_8U);
  const float scale = 255 / std::max(high - low, 1e-3f);
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const bool usable = picture.usable(x, y);
      const float value = usable ? std::clamp((picture.ln(x, y) - low) * scale, 0.0f, 255.0f) : 0.0f;
      grey.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(value));
      mask.at<std::uint8_t>(y, x) = usable ? 255 : 0;
    }
  }
  constexpr int kMostFeatures = 1500, kFastThreshold = 7;
  const cv::Ptr<cv::ORB> orb =
      cv::ORB::create(kMostFeatures, 1.2f, 4, 15, 0, 2, cv::ORB::HARRIS_SCORE, 31, kFastThreshold);
  Features features;
  orb->detectAndCompute(grey, mask, features.points, features.descriptors);
  return features;
}

/// The middle of the ln radiances that both shots can show: 1st to 99th percentile of the pixels usable in both.
bool common_range(const LogPicture& a, const LogPicture& b, float& low, float& high) {
  std::vector<float> values;
  for (int y = 0; y < a.ln.height(); ++y) {
    for (int x = 0; x < a.ln.width(); ++x) {
      if (a.usable(x, y) && b.usable(x, y)) values.push_back(a.ln(x, y));
    }
  }
  if (values.size() < 100) return false;
  std::sort(values.begin(), values.end());
  low = values[values.size() / 100];
  high = values[values.size() - 1 - values.size() / 100];
  return true;
}

/// Every match proposes its own shift; the one with the most others within `tolerance` wins. This is RANSAC's consensus
/// [Fischler81] with all samples tried: a shift needs one match only, so nothing is left to chance.
std::vector<Vec2> largest_consensus(const std::vector<Vec2>& shifts, double tolerance) {
  std::vector<Vec2> best;
  for (const Vec2& proposal : shifts) {
    std::vector<Vec2> agreeing;
    for (const Vec2& s : shifts) {
      if ((s - proposal).norm() < tolerance) agreeing.push_back(s);
    }
    if (agreeing.size() > best.size()) best = std::move(agreeing);
  }
  return best;
}

}  // namespace

PairMotion feature_shift(const LogPicture& a, const LogPicture& b) {
  float low = 0, high = 0;
  if (!common_range(a, b, low, high)) return failed("too few pixels in common");
  const Features in_a = features_of(a, low, high), in_b = features_of(b, low, high);
  if (in_a.points.empty() || in_b.points.empty()) return failed("no features");
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING, true).match(in_a.descriptors, in_b.descriptors, matches);
  std::vector<Vec2> shifts;
  for (const cv::DMatch& m : matches) {
    const cv::Point2f d =
        in_b.points[static_cast<std::size_t>(m.trainIdx)].pt - in_a.points[static_cast<std::size_t>(m.queryIdx)].pt;
    shifts.emplace_back(d.x, d.y);
  }
  constexpr double kTolerance = 1.5;
  constexpr std::size_t kFewest = 8;
  const std::vector<Vec2> agreeing = largest_consensus(shifts, kTolerance);
  if (agreeing.size() < kFewest || agreeing.size() * 10 < shifts.size())
    return failed("its features agree on no motion");
  Vec2 mean = Vec2::Zero();
  for (const Vec2& s : agreeing) mean += s;
  const auto n = static_cast<double>(agreeing.size());
  mean /= n;
  Mat2 scatter = Mat2::Zero();
  for (const Vec2& s : agreeing) scatter += (s - mean) * (s - mean).transpose();
  PairMotion motion;
  motion.b_from_a = mean * a.cell;
  motion.covariance = scatter / (n * (n - 1)) * (a.cell * a.cell);
  return motion;
}

}  // namespace hdr::internal
