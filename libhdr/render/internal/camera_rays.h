#pragma once
// Pixels of a picture -> rays of its camera.
#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/render/scene.h"

namespace hdr {

class CameraRays {
 public:
  /// Throws Error when the camera looks nowhere or has no field of view.
  CameraRays(const Camera& camera, Size size);

  const Vec3f& eye() const { return eye_; }
  /// Unit direction through a point of the picture (continuous pixels, y down).
  /// Of many places, in single precision.
  void dirs_from_px(const float* px, const float* py, int count, float* dir_x, float* dir_y, float* dir_z) const;
  Vec3f dir_from_px(const Vec2& px) const;

 private:
  Vec3f eye_;
  Vec3 forward_, right_, up_;  ///< right and up are as long as half the picture is wide, one unit ahead
  double width_, height_;
};

}  // namespace hdr
