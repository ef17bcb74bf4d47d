#pragma once
// Where a picture of a ball shows a direction, and how that place moves with what is not known for sure: the direction,
// the camera's distance, the outline.
#include <array>
#include <optional>

#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/ball_camera.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

/// The ball seen from another distance (1 / radii, 0: far), its outline's centre moved and its radius grown, in radii.
MirrorBall changed(const MirrorBall& ball, double inverse_distance, const Vec3& outline);

struct Glimpse {
  Vec2 px = Vec2::Zero();
  /// Derivatives: of moves across the direction; of the outline's centre and radius, in radii; of 1 / distance.
  Eigen::Matrix<double, 2, 3> px_from_dir = Eigen::Matrix<double, 2, 3>::Zero(), px_from_outline = px_from_dir;
  Vec2 px_from_inverse_distance = Vec2::Zero();
};

/// A ball changed once, looked at in many directions.
class BallGlimpses {
 public:
  BallGlimpses(const MirrorBall& ball, double inverse_distance, const Vec3& outline);
  /// nullopt where the ball does not show the direction.
  std::optional<Glimpse> operator()(const Vec3& dir) const;

 private:
  std::optional<Glimpse> from_afar(const Vec3& dir) const;

  double given_radius_;
  MirrorBall seen_;
  BallCamera camera_;                 ///< of a camera that is not far
  std::array<BallCamera, 4> varied_;  ///< likewise: with each part of the outline a little changed, and 1 / distance
};

}  // namespace hdr::internal
