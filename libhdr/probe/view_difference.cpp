#include "libhdr/probe/internal/view_difference.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace hdr::internal {

Mat3 turned(const Mat3& first, const double* turn) {
  const Vec3 v(turn[0], turn[1], turn[2]);
  const double angle = v.norm();
  return angle > 0 ? Mat3(Eigen::AngleAxisd(angle, v / angle).toRotationMatrix() * first) : first;
}

bool ViewDifference::Evaluate(double const* const* blocks, double* residual, double** jacobians) const {
  std::optional<Glimpse> seen[2];
  Vec3 before_first[2];
  for (std::size_t k = 0; k < 2; ++k) {
    before_first[k] = turned(Mat3::Identity(), blocks[k]).transpose() * dir_;
    const double* outline = blocks[6 + k];
    seen[k] = sides_[k].picture->glimpse(sides_[k].first.transpose() * before_first[k], std::max(0.0, *blocks[4 + k]),
                                         {outline[0], outline[1], outline[2]});
  }
  PatchMean light[2];
  const bool both = seen[0] && seen[1] && look(*seen[0], *seen[1], light);
  *residual = both ? scale_ * (light[0].value + *blocks[2] - light[1].value - *blocks[3]) : 0;
  if (!jacobians) return true;
  for (std::size_t k = 0; k < 2; ++k) {
    const double sign = both ? (k == 0 ? scale_ : -scale_) : 0;
    const Glimpse g = both ? *seen[k] : Glimpse();
    const Vec2& slope = light[k].slope;
    for (int axis = 0; axis < 3; ++axis) {
      // A turn of the view moves the direction the other way: exp(-[v]) d changes by (d x e) dv.
      const Vec3 moved = sides_[k].first.transpose() * before_first[k].cross(Vec3::Unit(axis));
      if (jacobians[k]) jacobians[k][axis] = sign * slope.dot(g.px_from_dir * moved);
    }
    if (jacobians[2 + k]) *jacobians[2 + k] = sign;
    if (jacobians[4 + k]) *jacobians[4 + k] = sign * slope.dot(g.px_from_inverse_distance);
    if (!jacobians[6 + k]) continue;
    const double r = sides_[k].picture->ball.disc.r;
    jacobians[6 + k][0] = sign * slope.x() * r;
    jacobians[6 + k][1] = sign * slope.y() * r;
    jacobians[6 + k][2] = sign * slope.dot(g.px_from_growth);
  }
  return true;
}

bool ViewDifference::look(const Glimpse& a, const Glimpse& b, PatchMean* light) const {
  // Pixels from moves across the direction, in one basis for both.
  const Vec3 t = dir_.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> across;
  across << t, dir_.cross(t);
  const Eigen::Matrix2d from_a = a.px_from_dir * sides_[0].first.transpose() * across;
  const Eigen::Matrix2d from_b = b.px_from_dir * sides_[1].first.transpose() * across;
  constexpr double kLeast = 1e-9;
  if (std::abs(from_a.determinant()) < kLeast || std::abs(from_b.determinant()) < kLeast) return false;
  light[0] = sides_[0].picture->mean(a.px, from_a * from_b.inverse());
  light[1] = sides_[1].picture->mean(b.px, from_b * from_a.inverse());
  return true;
}

}  // namespace hdr::internal
