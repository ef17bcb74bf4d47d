#pragma once
// What two views of a ball differ by in one direction of the sphere, as a cost for Ceres.
#include <ceres/sized_cost_function.h>

#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/ball_sphere.h"

namespace hdr::internal {

/// A small turn (axis times angle) on top of a rotation.
Mat3 turned(const Mat3& first, const double* turn);

/// In deviations of what such differences are. A pixel of one view is long where one of the other is wide: each is read
/// as a mean over what a pixel of the other shows, so that both are equally blurred.
/// Blocks: turns of a and b, log gains, inverse distances, outlines (centre moved, radius grown, in radii).
class ViewDifference : public ceres::SizedCostFunction<1, 3, 3, 1, 1, 1, 1, 3, 3> {
 public:
  struct Side {
    const LogView* picture;
    Mat3 first;  ///< probe from view, before the turn
  };
  /// `scale`: root of the weight over the deviation.
  ViewDifference(const Side& a, const Side& b, const Vec3& dir, double scale)
      : sides_{a, b}, dir_(dir), scale_(scale) {}

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  bool look(const Glimpse& a, const Glimpse& b, PatchMean* light) const;

  Side sides_[2];
  Vec3 dir_;
  double scale_;
};

}  // namespace hdr::internal
