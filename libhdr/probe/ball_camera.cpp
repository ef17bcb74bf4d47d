// The outline of a sphere under perspective. A sphere whose centre lies in direction b at D radii fills the cone of
// half-angle A = asin(1/D) around b. With a the angle between b and the camera's axis, the cone meets the picture plane
// at focal length f in an ellipse whose larger half-axis points at the principal point:
//   centre    f sin a cos a / (cos^2 A - sin^2 a)  from the principal point
//   major     f sin A cos A / (cos^2 A - sin^2 a)
//   minor     f sin A / sqrt(cos^2 A - sin^2 a)
// (from (d.b)^2 = cos^2 A |d|^2 with d = (x, y, 1)). The minor half-axis r and the centre's offset o are what a
// MirrorBall holds; D, f or the elongation gives the rest in closed form.
#include "libhdr/probe/internal/ball_camera.h"

#include <algorithm>
#include <cmath>

namespace hdr::internal {
namespace {

/// sin^2 a from r, o and sin^2 A: r^2 s (1 - s) = o^2 sin^2 A (cos^2 A - s), the smaller root.
double sin2_off_axis(double r, double o, double sin2) {
  const double b = r * r + o * o * sin2, c = o * o * sin2 * (1 - sin2);
  return 2 * c / (b + std::sqrt(std::max(0.0, b * b - 4 * r * r * c)));
}

double offset_of(const MirrorBall& ball) {
  return (Vec2(ball.disc.cx, ball.disc.cy) - *ball.principal).norm();
}

bool on_axis(const MirrorBall& ball) {
  return !ball.principal || std::isinf(ball.distance) || offset_of(ball) < 1e-9 * ball.disc.r;
}

}  // namespace

ReflectionPlane::ReflectionPlane(const BallCamera& camera, const Vec3& dir) : to_camera(-camera.to_ball) {
  constexpr double kOnAxis = 1e-12;
  const Vec3 across = dir - dir.dot(to_camera) * to_camera;
  sine = across.norm();
  theta = std::atan2(sine, dir.dot(to_camera));
  side = sine > kOnAxis ? Vec3(across / sine) : to_camera.unitOrthogonal();
}

Vec3 ReflectionPlane::point_at(const BallCamera& camera, double normal_angle) const {
  return camera.distance * camera.to_ball + std::cos(normal_angle) * to_camera + std::sin(normal_angle) * side;
}

Vec2 px_of(const BallCamera& camera, const Vec3& point) {
  return {camera.principal.x() + camera.focal_px * point.x() / -point.z(),
          camera.principal.y() - camera.focal_px * point.y() / -point.z()};
}

BallCamera camera_of(const MirrorBall& ball) {
  const double sin2 = 1 / (ball.distance * ball.distance);
  const double r = ball.disc.r, o = offset_of(ball);
  const double s = sin2_off_axis(r, o, sin2);
  BallCamera camera{*ball.principal, r * std::sqrt((1 - sin2 - s) / sin2), ball.distance};
  if (on_axis(ball)) return camera;
  const Vec2 out = (Vec2(ball.disc.cx, ball.disc.cy) - *ball.principal) / o;
  camera.to_ball = {std::sqrt(s) * out.x(), -std::sqrt(s) * out.y(), -std::sqrt(1 - s)};
  return camera;
}

Ellipse outline_of(const MirrorBall& ball) {
  Ellipse outline = circle_of(ball.disc);
  if (on_axis(ball)) return outline;
  const double sin2 = 1 / (ball.distance * ball.distance), o = offset_of(ball);
  const double s = sin2_off_axis(ball.disc.r, o, sin2);
  outline.along = (outline.centre - *ball.principal) / o;
  outline.major = ball.disc.r * std::sqrt((1 - sin2) / (1 - sin2 - s));
  return outline;
}

/// With q = cos^2 A - sin^2 a and k = 1 + r^2 / f^2: sin^2 A = q r^2 / f^2, sin^2 a = 1 - q k, and
/// o^2 / f^2 = k (1 - q k) / q.
MirrorBall ball_from_focal(const Disc& disc, const Vec2& principal, double focal_px) {
  const double r2 = disc.r * disc.r / (focal_px * focal_px);
  const double o2 = (Vec2(disc.cx, disc.cy) - principal).squaredNorm() / (focal_px * focal_px);
  const double k = 1 + r2;
  const double q = k / (k * k + o2);
  return {disc, 1 / std::sqrt(q * r2), principal};
}

/// With m = 1 - 1 / elongation^2 = sin^2 a / cos^2 A: sin^2 A (o^2 (1 - m) - r^2 m^2) = r^2 m (1 - m).
std::optional<MirrorBall> ball_from_elongation(const Disc& disc, const Vec2& principal, double elongation) {
  const double m = 1 - 1 / (elongation * elongation);
  const double r2 = disc.r * disc.r, o2 = (Vec2(disc.cx, disc.cy) - principal).squaredNorm();
  const double divisor = o2 * (1 - m) - r2 * m * m, dividend = r2 * m * (1 - m);
  if (!(m > 0) || !(divisor > dividend)) return std::nullopt;
  return MirrorBall{disc, std::sqrt(divisor / dividend), principal};
}

}  // namespace hdr::internal
