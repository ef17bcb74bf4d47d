#include "libhdr/probe/internal/ball_glimpse.h"

#include <cmath>
#include <limits>

#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

constexpr double kStep = 1e-6;  ///< of 1 / distance and of the outline in radii, for derivatives

/// The angle psi of the normal from the direction to the camera, normal_angle's, and how it follows.
struct NormalAngle {
  NormalAngle(double theta, double d) : psi(normal_angle(theta, d)) {
    const double c = std::cos(psi), s = std::sin(psi), square = 1 + d * d - 2 * d * c;
    from_theta = 1 / (2 + (d * c - 1) / square);
    from_distance = from_theta * s / square;
  }
  double psi, from_theta, from_distance;
};

/// Of the place where the ball shows the plane's direction, by moves of it across itself: in the plane the normal's
/// angle follows, around the axis both turn alike.
Eigen::Matrix<double, 2, 3> px_from_dir(const BallCamera& camera, const ReflectionPlane& plane,
                                        const NormalAngle& normal, const Vec3& point) {
  constexpr double kOnAxis = 1e-9;
  const double c = std::cos(normal.psi), s = std::sin(normal.psi);
  const double around = plane.sine > kOnAxis ? s / plane.sine : normal.from_theta;
  const Vec3 outwards = std::cos(plane.theta) * plane.side - plane.sine * plane.to_camera;
  const Vec3 turn = plane.to_camera.cross(plane.side);
  const double nearer = -1 / point.z();
  Eigen::Matrix<double, 2, 3> px_from_point;
  px_from_point << nearer, 0, point.x() * nearer * nearer, 0, -nearer, -point.y() * nearer * nearer;
  px_from_point *= camera.focal_px;
  return px_from_point * (normal.from_theta * (c * plane.side - s * plane.to_camera) * outwards.transpose() +
                          around * turn * turn.transpose());
}

BallCamera camera_at(MirrorBall ball) {
  if (std::isinf(ball.distance)) return {};
  if (!ball.principal) ball.principal = Vec2(ball.disc.cx, ball.disc.cy);
  return camera_of(ball);
}

}  // namespace

MirrorBall changed(const MirrorBall& ball, double inverse_distance, const Vec3& outline) {
  constexpr double kFar = 1e-7;
  MirrorBall result = ball;
  result.distance = inverse_distance > kFar ? 1 / inverse_distance : std::numeric_limits<double>::infinity();
  const double r = ball.disc.r;
  result.disc = {ball.disc.cx + r * outline.x(), ball.disc.cy + r * outline.y(), r * (1 + outline.z())};
  return result;
}

BallGlimpses::BallGlimpses(const MirrorBall& ball, double inverse_distance, const Vec3& outline)
    : given_radius_(ball.disc.r), seen_(changed(ball, inverse_distance, outline)), camera_(camera_at(seen_)) {
  for (int k = 0; k < 3; ++k) {
    varied_[static_cast<std::size_t>(k)] = camera_at(changed(ball, inverse_distance, outline + kStep * Vec3::Unit(k)));
  }
  varied_[3] = camera_at(changed(ball, inverse_distance + kStep, outline));
}

std::optional<Glimpse> BallGlimpses::operator()(const Vec3& dir) const {
  if (std::isinf(seen_.distance)) return from_afar(dir);
  const ReflectionPlane plane(camera_, dir);
  if (plane.theta > kPi - std::asin(1 / camera_.distance)) return std::nullopt;
  const NormalAngle normal(plane.theta, camera_.distance);
  const Vec3 point = plane.point_at(camera_, normal.psi);
  Glimpse result;
  result.px = px_of(camera_, point);
  result.px_from_dir = px_from_dir(camera_, plane, normal, point);
  for (std::size_t k = 0; k < varied_.size(); ++k) {
    const BallCamera& varied = varied_[k];
    const ReflectionPlane there(varied, dir);
    const double psi = normal.psi + normal.from_theta * (there.theta - plane.theta) +
                       normal.from_distance * (varied.distance - camera_.distance);
    const Vec2 slope = (px_of(varied, there.point_at(varied, psi)) - result.px) / kStep;
    if (k < 3) {
      result.px_from_outline.col(static_cast<Eigen::Index>(k)) = slope;
    } else {
      result.px_from_inverse_distance = slope;
    }
  }
  return result;
}

/// The normal lies halfway between the direction and +Z. A far camera stays far.
std::optional<Glimpse> BallGlimpses::from_afar(const Vec3& dir) const {
  constexpr double kBehind = 1e-6;  // the whole rim shows -Z
  const Vec3 sum = dir + Vec3::UnitZ();
  const double length = sum.norm(), r = seen_.disc.r;
  if (length < kBehind) return std::nullopt;
  const Vec3 n = sum / length;
  Glimpse result;
  result.px = Vec2(seen_.disc.cx + r * n.x(), seen_.disc.cy - r * n.y());
  const Mat3 n_from_dir = (Mat3::Identity() - n * n.transpose()) / length;
  result.px_from_dir.row(0) = r * n_from_dir.row(0);
  result.px_from_dir.row(1) = -r * n_from_dir.row(1);
  result.px_from_outline << given_radius_, 0, given_radius_ * n.x(), 0, given_radius_, -given_radius_ * n.y();
  return result;
}

}  // namespace hdr::internal
