#pragma once
// How likely a profile across a circle is, if an outline lies somewhere along it, and if something else does.
#include <Eigen/Core>
#include <vector>

namespace hdr::internal {

/// How fast radiance wanders along a radius.
struct Clock {
  bool outline;    ///< inside the clock runs as the square root of the distance to the rim
  double step;     ///< expected size of a step at the rim
  double outside;  ///< variance a pixel outside, against 1 for the first pixel inside
  double noise;    ///< variance of a pixel, likewise
};

/// A sample of all profiles a row, a profile a column; columns of zeros fill up the last vector (kWhitenedColumns).
/// Single precision does for some fifteen samples near 0.
using SampleRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// ln likelihood of profiles of 2 `half_window` + 1 samples, one a pixel, with the outline (or the edge) `shift` beyond
/// their middle, whose covariance is known up to its scale.
class ProfileLikelihood {
 public:
  ProfileLikelihood(const Clock& clock, int half_window, double shift);
  /// Of the first `count` columns. `floor`: what noise adds to a profile's squares.
  Eigen::ArrayXd operator()(const SampleRows& profiles, Eigen::Index count, double floor) const;

 private:
  SampleRows whitening_;
  double half_log_determinant_;
};

/// How the picture wanders is not known beforehand: these are tried, one for all the radii of a circle.
std::vector<Clock> outline_clocks();

/// What else a radius may cross, each for itself: nothing, or the edge of something that is no mirror.
std::vector<ProfileLikelihood> other_likelihoods(int half_window, int range);

}  // namespace hdr::internal
