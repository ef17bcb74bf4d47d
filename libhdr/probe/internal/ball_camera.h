#pragma once
// A ball beside the camera's axis: its outline is an ellipse, and the true rays are those of the whole camera.
#include <optional>

#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

/// Angle psi between the normal and the direction to the camera where a ball shows a camera at d radii the direction
/// at angle theta from the one to the camera: theta = 2 psi + atan2(sin psi, d - cos psi).
double normal_angle(double theta, double d);

/// An ellipse; the circle has minor = major.
struct Ellipse {
  Vec2 centre{0, 0};
  Vec2 along{1, 0};  ///< unit, of the larger half-axis
  double major = 0, minor = 0;

  /// The picture squeezed along the larger axis, about the centre, so that the ellipse becomes a circle.
  Vec2 squeezed(const Vec2& px) const { return px - (1 - minor / major) * (px - centre).dot(along) * along; }
};

/// The pinhole camera of a MirrorBall with a principal point and a finite distance. Its axes are the picture's: right
/// +X, up +Y, it looks along -Z.
struct BallCamera {
  Vec2 principal{0, 0};
  double focal_px = 0;
  double distance = 0;     ///< of the ball's centre, radii
  Vec3 to_ball{0, 0, -1};  ///< unit

  Vec3 ray(const Vec2& px) const {
    return Vec3((px.x() - principal.x()) / focal_px, -(px.y() - principal.y()) / focal_px, -1).normalized();
  }
};

inline Ellipse circle_of(const Disc& disc) {
  return {{disc.cx, disc.cy}, {1, 0}, disc.r, disc.r};
}

/// The plane through the camera, the ball's centre and a direction, in which the ray that shows it is reflected.
struct ReflectionPlane {
  ReflectionPlane(const BallCamera& camera, const Vec3& dir);
  /// The ball's point, from the camera, whose normal is at this angle from `to_camera`.
  Vec3 point_at(const BallCamera& camera, double normal_angle) const;

  Vec3 to_camera, side;  ///< unit, at right angles; behind the ball every side is as good
  double theta, sine;    ///< of the direction from the one to the camera
};

/// Where the camera sees a point of its own axes.
Vec2 px_of(const BallCamera& camera, const Vec3& point);

/// The camera that sees this outline at this distance.
BallCamera camera_of(const MirrorBall& ball);

/// The outline of any MirrorBall.
Ellipse outline_of(const MirrorBall& ball);

/// The ball that a camera with this focal length and principal point sees with this outline (centre, smaller
/// half-axis).
MirrorBall ball_from_focal(const Disc& disc, const Vec2& principal, double focal_px);

/// The same from the outline's elongation, major / minor > 1: the only focal length that fits. nullopt when none does.
std::optional<MirrorBall> ball_from_elongation(const Disc& disc, const Vec2& principal, double elongation);

}  // namespace hdr::internal
