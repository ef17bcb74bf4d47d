#include "libhdr/render/internal/camera_rays.h"

#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr {

CameraRays::CameraRays(const Camera& camera, Size size) : eye_(camera.eye), width_(size.width), height_(size.height) {
  const Vec3 towards = (camera.look - camera.eye).cast<double>();
  if (!(towards.norm() > 0) || !towards.allFinite()) {
    throw Error("the camera stands where it looks; make --eye and --look different points");
  }
  if (!(camera.fov_degrees > 0 && camera.fov_degrees < 180)) {
    throw Error("the camera's field of view must lie between 0 and 180 degrees; mend --fov");
  }
  forward_ = towards.normalized();
  // A camera that looks straight up or down has -Z or +Z at its top, as if it had tilted there from looking along -Z.
  Vec3 above = camera.up.cast<double>();
  if (!(above.norm() > 0) || !above.allFinite()) above = Vec3::UnitY();
  above.normalize();
  if (forward_.cross(above).norm() < 1e-6)
    above = std::abs(forward_.y()) < 0.5 ? Vec3(0, 1, 0) : forward_.y() > 0 ? Vec3(0, 0, 1) : Vec3(0, 0, -1);
  const double half = std::tan(0.5 * camera.fov_degrees * kDegree);
  const Vec3 right = forward_.cross(above).normalized();
  right_ = half * right;
  up_ = half * right.cross(forward_);
}

Vec3f CameraRays::dir_from_px(const Vec2& px) const {
  const double x = 2 * px.x() / width_ - 1, y = (height_ - 2 * px.y()) / width_;
  return (forward_ + x * right_ + y * up_).normalized().cast<float>();
}

void CameraRays::dirs_from_px(const float* px, const float* py, int count, float* __restrict dir_x,
                              float* __restrict dir_y, float* __restrict dir_z) const {
  // px and py from the picture's middle, in halves of its width.
  const Vec3f middle = forward_.cast<float>(), right = right_.cast<float>(), up = up_.cast<float>();
  const auto half = static_cast<float>(0.5 * width_), middle_y = static_cast<float>(0.5 * height_);
  for (int k = 0; k < count; ++k) {
    const float x = (px[k] - half) / half, y = (middle_y - py[k]) / half;
    const float dx = middle.x() + x * right.x() + y * up.x();
    const float dy = middle.y() + x * right.y() + y * up.y();
    const float dz = middle.z() + x * right.z() + y * up.z();
    const float scale = 1 / std::sqrt(dx * dx + dy * dy + dz * dz);
    dir_x[k] = scale * dx;
    dir_y[k] = scale * dy;
    dir_z[k] = scale * dz;
  }
}

}  // namespace hdr
