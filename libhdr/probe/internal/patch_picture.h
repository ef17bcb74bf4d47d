#pragma once
// A picture of one channel that is read in means over small parallelograms.
#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

struct PatchMean {
  double value = 0;
  Vec2 slope = Vec2::Zero();  ///< a pixel by which the parallelogram moves
};

/// Value and slopes of each pixel stand side by side, so that one reading gives all of them.
class PatchPicture {
 public:
  explicit PatchPicture(View<const float> picture);
  bool holds(const Vec2& px) const {
    return px.x() > 0 && px.y() > 0 && px.x() < pixels_.width() && px.y() < pixels_.height();
  }
  /// Around px, in continuous pixel coordinates; the parallelogram's sides are the columns. Beyond the frame its border
  /// goes on.
  PatchMean mean(const Vec2& px, const Eigen::Matrix2d& sides) const;

 private:
  Image<float> pixels_;  ///< value, slope along x, slope along y, 0
};

}  // namespace hdr::internal
