#pragma once
// A scene seen from infinitely far away: how near each place of a window is to the sky.
#include "libhdr/core/image.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// Orthographic, from `towards` down; x and y of a window's texel along two directions across it.
class DepthMap {
 public:
  DepthMap() = default;
  /// The window holds the box between `low` and `high`; what stands outside of it and in the way is drawn too.
  DepthMap(const Scene& scene, const Vec3f& towards, const Vec3f& low, const Vec3f& high, int side);

  const Vec3f& towards() const { return towards_; }

  /// Share of the four nearest texels whose sky is seen from a point on a plane, as near as they are: percentage-closer
  /// filtering [Reeves87], each texel held against the plane where the texel is. What is less than a texel above the
  /// plane does not count. 1 outside of the window.
  float open(const Vec3f& position, const Vec3f& normal) const;

 private:
  void draw(const Vec3f& a, const Vec3f& b, const Vec3f& c);

  Vec3f towards_, across_, up_;
  float left_ = 0, bottom_ = 0, texel_x_ = 1, texel_y_ = 1, margin_ = 0;
  Image<float> depth_;  ///< along `towards`; minus infinity where there is nothing
};

}  // namespace hdr
