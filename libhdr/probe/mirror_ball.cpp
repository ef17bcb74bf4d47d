// The mirror ball, the exact ray. The ball has radius 1 and its centre at the origin, the camera is a pinhole at
// (0, 0, D) that looks along -Z. Disc coordinates (x, y), outline at 1, y up: the pixel's ray is (x t, y t, -1) with
// t = tan A = 1 / sqrt(D^2 - 1), A = asin(1/D) being half the angle that the ball fills. D = infinity: rays along -Z.
#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/ball_normal.h"
#include "libhdr/probe/internal/ball_camera.h"
#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

/// Disc radius at which a far camera sees the direction at angle theta from +Z: sin(theta / 2), without cancellation at
/// either end.
double far_radius(double sin_theta, double cos_theta) {
  return cos_theta > 0 ? sin_theta / std::sqrt(2 * (1 + cos_theta)) : std::sqrt(0.5 * (1 - cos_theta));
}

}  // namespace

/// Angle psi of the normal at which the ball shows a camera at D the direction at angle theta:
///   theta = 2 psi + atan2(sin psi, D - cos psi),
/// which rises on [0, acos(1/D)]. Newton's steps, kept inside a bracket that bisection shrinks.
double internal::normal_angle(double theta, double d) {
  constexpr int kMostSteps = 60;
  constexpr double kTolerance = 1e-13;
  const double psi_rim = std::acos(1 / d);
  double low = 0, high = psi_rim;
  double psi = std::min(high, theta * psi_rim / (kPi - std::asin(1 / d)));
  for (int step = 0; step < kMostSteps; ++step) {
    const double s = std::sin(psi), c = std::cos(psi);
    const double error = 2 * psi + std::atan2(s, d - c) - theta;
    (error > 0 ? high : low) = psi;
    const double slope = 2 + (d * c - 1) / (d * d + 1 - 2 * d * c);
    double next = psi - error / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const bool done = std::abs(next - psi) < kTolerance;
    psi = next;
    if (done) break;
  }
  return psi;
}

namespace {

/// Disc radius at which a camera at D sees the direction at angle theta; nullopt in the cone that the ball hides.
std::optional<double> near_radius(double theta, double d) {
  constexpr double kRounding = 1e-14;
  if (theta > kPi - std::asin(1 / d) + kRounding) return std::nullopt;
  const double psi = internal::normal_angle(theta, d);
  return std::min(1.0, std::sin(psi) / (d - std::cos(psi)) * std::sqrt(d * d - 1));
}

void require_outside(double d) {
  if (!(d > 1)) throw Error("mirror-ball: the camera is inside the ball; give a distance above 1 radius");
}

/// Where a ray meets the ball whose centre lies at D b: with c = v.b, at D c - h along v, h the root of
/// 1 - D^2 |v x b|^2, which is also the cosine of incidence. nullopt when it passes the ball.
struct Meeting {
  Vec3 ray, normal;
  double cosine;
};

std::optional<Meeting> meeting(const internal::BallCamera& camera, const Vec2& px) {
  const Vec3 v = camera.ray(px), &b = camera.to_ball;
  const double h2 = 1 - camera.distance * camera.distance * v.cross(b).squaredNorm();
  if (h2 < 0 || v.dot(b) < 0) return std::nullopt;
  const double h = std::sqrt(h2);
  return Meeting{v, camera.distance * v.cross(v.cross(b)) - h * v, h};
}

bool beside_axis(const MirrorBall& ball) {
  return ball.principal && std::isfinite(ball.distance);
}

}  // namespace

namespace {

/// The camera's axis goes through the ball's centre: the ray (0, 0, D) + s v meets the sphere where
/// v.v s^2 - 2 D s + D^2 - 1 = 0; its discriminant is 1 - x^2 - y^2. For a far camera n = (x, y, z).
std::optional<Meeting> meeting_on_axis(const MirrorBall& ball, const Vec2& px) {
  const double x = (px.x() - ball.disc.cx) / ball.disc.r;
  const double y = -(px.y() - ball.disc.cy) / ball.disc.r;
  const double radius2 = x * x + y * y;
  if (radius2 > 1) return std::nullopt;
  const double z = std::sqrt(1 - radius2);
  if (std::isinf(ball.distance)) return Meeting{{0, 0, -1}, {x, y, z}, z};
  const double d = ball.distance, t = 1 / std::sqrt(d * d - 1);
  const Vec3 v(x * t, y * t, -1);
  const Vec3 n = Vec3(0, 0, d) + (d - z) / v.squaredNorm() * v;
  return Meeting{v, n, -n.dot(v)};
}

std::optional<Meeting> meeting_at(const MirrorBall& ball, const Vec2& px) {
  require_outside(ball.distance);
  return beside_axis(ball) ? meeting(internal::camera_of(ball), px) : meeting_on_axis(ball, px);
}

}  // namespace

std::optional<Vec3> MirrorBall::dir_from_px(const Vec2& px) const {
  const auto met = meeting_at(*this, px);
  if (!met) return std::nullopt;
  return (met->ray + 2 * met->cosine * met->normal).normalized();  // v - 2 (n.v) n
}

std::optional<Vec3> normal_from_px(const MirrorBall& ball, const Vec2& px) {
  const auto met = meeting_at(ball, px);
  return met ? std::optional(met->normal.normalized()) : std::nullopt;
}

namespace {

/// The normal lies between the direction and the one to the camera; its point on the ball goes through the camera.
std::optional<Vec2> px_beside_axis(const MirrorBall& ball, const Vec3& dir) {
  constexpr double kRounding = 1e-14;
  const internal::BallCamera camera = internal::camera_of(ball);
  const internal::ReflectionPlane plane(camera, dir);
  if (plane.theta > kPi - std::asin(1 / camera.distance) + kRounding) return std::nullopt;
  return px_of(camera, plane.point_at(camera, internal::normal_angle(plane.theta, camera.distance)));
}

}  // namespace

/// For a far camera -Z is the whole rim; its rightmost point stands for it.
std::optional<Vec2> MirrorBall::px_from_dir(const Vec3& dir) const {
  require_outside(distance);
  if (beside_axis(*this)) return px_beside_axis(*this, dir);
  const double sin_theta = std::sqrt(dir.x() * dir.x() + dir.y() * dir.y());
  const auto radius = std::isinf(distance) ? std::optional(far_radius(sin_theta, dir.z()))
                                           : near_radius(std::atan2(sin_theta, dir.z()), distance);
  if (!radius) return std::nullopt;
  if (sin_theta == 0) return Vec2(disc.cx + disc.r * *radius, disc.cy);
  return Vec2(disc.cx + disc.r * *radius * dir.x() / sin_theta, disc.cy - disc.r * *radius * dir.y() / sin_theta);
}

MirrorBall ball_in_photograph(const Disc& disc, Size size, double fov_degrees) {
  require_valid(Rectilinear{size, fov_degrees});
  const double focal_px = 0.5 * size.width / std::tan(0.5 * fov_degrees * kDegree);
  return internal::ball_from_focal(disc, {0.5 * size.width, 0.5 * size.height}, focal_px);
}

std::optional<double> cos_incidence(const MirrorBall& ball, const Vec2& px) {
  if (beside_axis(ball)) {
    const auto met = meeting(internal::camera_of(ball), px);
    return met ? std::optional(met->cosine) : std::nullopt;
  }
  const double radius2 = (px - Vec2(ball.disc.cx, ball.disc.cy)).squaredNorm() / (ball.disc.r * ball.disc.r);
  if (radius2 > 1) return std::nullopt;
  // 1 - D^2 |v x b|^2 with v = (x t, y t, -1), t^2 = 1 / (D^2 - 1); far: 1 - radius^2.
  const double behind = ball.distance * ball.distance - 1;
  return std::sqrt((1 - radius2) * (std::isinf(behind) ? 1 : behind / (behind + radius2)));
}

}  // namespace hdr
