// Features: ORB [Rublee11] on exposure-normalised pictures, and the rigid motion on which most matches agree.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <optional>

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

/// Places that match, in pixels of the photographs.
struct Matches {
  std::vector<cv::Point2f> a, b;
};

Matches matches_of(const LogPicture& a, const LogPicture& b, const Features& in_a, const Features& in_b) {
  std::vector<cv::DMatch> found;
  cv::BFMatcher(cv::NORM_HAMMING, true).match(in_a.descriptors, in_b.descriptors, found);
  const auto photograph = [](const LogPicture& picture, const cv::Point2f& p) {
    const auto cell = static_cast<float>(picture.cell);
    return cv::Point2f(cell * p.x + 0.5f * (cell - 1), cell * p.y + 0.5f * (cell - 1));
  };
  Matches matches;
  for (const cv::DMatch& m : found) {
    matches.a.push_back(photograph(a, in_a.points[static_cast<std::size_t>(m.queryIdx)].pt));
    matches.b.push_back(photograph(b, in_b.points[static_cast<std::size_t>(m.trainIdx)].pt));
  }
  return matches;
}

/// Every match proposes its own shift; the one with the most others within the tolerance wins. This is RANSAC's
/// consensus [Fischler81] with all samples tried: a shift needs one match only, so nothing is left to chance.
Vec2 shift_consensus(const Matches& matches, double tolerance_px, std::size_t& agreeing) {
  std::vector<Vec2> shifts;
  for (std::size_t k = 0; k < matches.a.size(); ++k) {
    shifts.emplace_back(matches.b[k].x - matches.a[k].x, matches.b[k].y - matches.a[k].y);
  }
  Vec2 best = Vec2::Zero();
  agreeing = 0;
  for (const Vec2& proposal : shifts) {
    Vec2 sum = Vec2::Zero();
    std::size_t count = 0;
    for (const Vec2& s : shifts) {
      if ((s - proposal).norm() > tolerance_px) continue;
      sum += s;
      ++count;
    }
    if (count <= agreeing) continue;
    agreeing = count;
    best = sum / static_cast<double>(count);
  }
  return best;
}

/// The rigid motion on which most matches agree [Fischler81]; OpenCV's consensus knows a zoom, which a bracket has not.
std::optional<Mat3> rigid_consensus(const Matches& matches, double tolerance_px, std::size_t& agreeing) {
  constexpr double kMostZoom = 0.03;
  std::vector<std::uint8_t> inlier;
  const cv::Mat found =
      cv::estimateAffinePartial2D(matches.a, matches.b, inlier, cv::RANSAC, tolerance_px, 5000, 0.999);
  agreeing = static_cast<std::size_t>(std::count(inlier.begin(), inlier.end(), 1));
  if (found.empty() || agreeing == 0) return std::nullopt;
  const double cosine = found.at<double>(0, 0), sine = found.at<double>(1, 0);
  if (std::abs(std::hypot(cosine, sine) - 1) > kMostZoom) return std::nullopt;
  const Eigen::Rotation2Dd turn(std::atan2(sine, cosine));
  // The zoom that was found is noise: without it the middle of the matches stays where they say.
  Vec2 shift = Vec2::Zero();
  for (std::size_t k = 0; k < inlier.size(); ++k) {
    if (inlier[k] == 0) continue;
    const Vec2 from(matches.a[k].x, matches.a[k].y), to(matches.b[k].x, matches.b[k].y);
    shift += (to - turn * from) / static_cast<double>(agreeing);
  }
  Mat3 motion = shift_by(shift);
  motion.topLeftCorner<2, 2>() = turn.toRotationMatrix();
  return motion;
}

}  // namespace

PairMotion feature_motion(const Pyramid& a, const Pyramid& b) {
  const LogPicture &pa = a.levels.front(), &pb = b.levels.front();
  float low = 0, high = 0;
  if (!common_range(pa, pb, low, high)) return failed("too few pixels in common");
  const Features in_a = features_of(pa, low, high), in_b = features_of(pb, low, high);
  if (in_a.points.empty() || in_b.points.empty()) return failed("no features");
  const Matches matches = matches_of(pa, pb, in_a, in_b);
  // A shift needs less agreement than a turn to be believed; a turn that explains half as many matches more is one.
  const double tolerance = 1.5 * pa.cell;
  std::size_t shifted = 0, turned = 0;
  const Vec2 shift = shift_consensus(matches, tolerance, shifted);
  const std::optional<Mat3> turn = rigid_consensus(matches, tolerance, turned);
  const bool rigid = turn && 2 * turned > 3 * shifted;
  const std::size_t agreeing = rigid ? turned : shifted;
  constexpr std::size_t kFewest = 8;
  if (agreeing < kFewest || agreeing * 10 < matches.a.size()) return failed("its features agree on no motion");
  // Each match is as wrong as its tolerance allows, in each axis.
  const double variance = tolerance * tolerance / 4 / static_cast<double>(agreeing);
  PairMotion found = shift_motion(a.size, shift, variance * Mat2::Identity());
  found.inliers = static_cast<double>(agreeing) / static_cast<double>(matches.a.size());
  if (!rigid) return found;
  found.b_from_a = *turn;
  found.model = found.richest = MotionModel::kRigid;
  found.measured[1].covariance.diagonal().head<3>() << variance, variance, 4 * variance;
  return found;
}

}  // namespace hdr::internal
