#pragma once
// What two views of a ball differ by in one direction of the sphere, as costs for Ceres.
//
// A pixel of one view is long where one of the other is wide: each is read as a mean over what a pixel of the other
// shows, so that both are equally blurred.
#include <ceres/evaluation_callback.h>
#include <ceres/problem.h>

#include <array>
#include <vector>

#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/ball_sphere.h"
#include "libhdr/probe/internal/patch_picture.h"

namespace hdr::internal {

/// A small turn (axis times angle) on top of a rotation.
Mat3 turned(const Mat3& first, const double* turn);

/// What is fitted of a view, where Ceres keeps it.
struct FittedView {
  Mat3 first;  ///< probe from view, before the turn
  double *turn, *log_gain, *inverse_distance;
  double* outline;  ///< centre moved, radius grown, in radii
};

/// All differences of a problem. They are worked out in parallel, each on its own, as soon as the unknowns have
/// changed; Ceres then takes them one by one, so that its sums stay in one order whatever the number of threads.
class ViewDifferences : public ceres::EvaluationCallback {
 public:
  struct Pair {
    std::size_t i, j;  ///< views
    Vec3 dir;          ///< of the probe
    double scale;      ///< root of the weight over the deviation that such differences have
  };
  ViewDifferences(std::vector<FittedView> views, const std::vector<LogView>& pictures, std::vector<Pair> pairs);

  /// A residual a pair, to a problem whose evaluation_callback this is.
  void add_to(ceres::Problem& problem, ceres::LossFunction* loss);
  void PrepareForEvaluation(bool jacobians, bool new_point) override;

  /// How a residual changes with what is fitted of one of its views.
  struct Slopes {
    double log_gain = 0, inverse_distance = 0;
    std::array<double, 3> turn{}, outline{};
  };
  struct Difference {
    double residual = 0;
    std::array<Slopes, 2> slopes{};
  };

 private:
  struct Sight;
  Difference difference_of(const Pair& pair, const std::vector<Sight>& sights) const;
  std::vector<double> unknowns() const;

  std::vector<FittedView> views_;
  std::vector<MirrorBall> balls_;
  std::vector<PatchPicture> pictures_;
  std::vector<Pair> pairs_;
  std::vector<double> known_for_;  ///< the unknowns that the differences belong to
  std::vector<Difference> differences_;
};

}  // namespace hdr::internal
