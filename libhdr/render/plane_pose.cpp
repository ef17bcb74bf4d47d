#include "libhdr/render/plane_pose.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

using Corners = std::array<Vec2, 4>;

// Pixels around the middle of the picture, x to the right and y up, in half widths.
Corners centred(const Corners& px, Size picture) {
  Corners result;
  const double half = 0.5 * picture.width;
  for (std::size_t k = 0; k < 4; ++k)
    result[k] = {(px[k].x() - half) / half, (0.5 * picture.height - px[k].y()) / half};
  return result;
}

// Of the ground, x to the right and y away from the photographer.
Corners on_ground(const PhotographedRectangle& seen) {
  const double w = 0.5 * seen.width, d = 0.5 * seen.depth;
  return {Vec2(-w, -d), Vec2(w, -d), Vec2(w, d), Vec2(-w, d)};
}

// The homography with H22 = 1 that takes the four ground points to their places in the picture.
Mat3 homography(const Corners& ground, const Corners& seen) {
  Eigen::Matrix<double, 8, 8> a;
  Eigen::Matrix<double, 8, 1> b;
  for (int k = 0; k < 4; ++k) {
    const Vec2 g = ground[static_cast<std::size_t>(k)], s = seen[static_cast<std::size_t>(k)];
    a.row(2 * k) << g.x(), g.y(), 1, 0, 0, 0, -s.x() * g.x(), -s.x() * g.y();
    a.row(2 * k + 1) << 0, 0, 0, g.x(), g.y(), 1, -s.y() * g.x(), -s.y() * g.y();
    b.segment<2>(2 * k) = s;
  }
  const Eigen::Matrix<double, 8, 1> h = a.fullPivLu().solve(b);
  Mat3 matrix;
  matrix << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  return matrix;
}

// [Zhang00] section 3.1 with a known middle and square pixels: the images h1, h2 of two perpendicular directions of
// equal length satisfy h1' B h2 = 0 and h1' B h1 = h2' B h2 with B = diag(1, 1, f^2) / f^2. Two equations for one
// unknown: by least squares.
std::optional<double> focal_length(const Mat3& h) {
  const Vec3 h1 = h.col(0), h2 = h.col(1);
  const Vec2 depth(h1.z() * h2.z(), h1.z() * h1.z() - h2.z() * h2.z());
  const Vec2 across(h1.head<2>().dot(h2.head<2>()), h1.head<2>().squaredNorm() - h2.head<2>().squaredNorm());
  // Both directions run along the picture: no perspective, and any focal length.
  if (depth.norm() < 1e-9 * (h1.squaredNorm() + h2.squaredNorm())) return std::nullopt;
  const double f2 = -depth.dot(across) / depth.squaredNorm();
  if (!(f2 > 1e-4) || !(f2 < 1e6)) return std::nullopt;
  return std::sqrt(f2);
}

// camera_from_ground, the camera looking along -z with y up; ground points are (x, y, 0).
struct Pose {
  Mat3 turn = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  double focal = 1;

  Vec2 see(const Vec2& g) const {
    const Vec3 p = turn.col(0) * g.x() + turn.col(1) * g.y() + shift;
    return focal / -p.z() * p.head<2>();
  }
};

Pose pose_of(const Mat3& h, double focal) {
  // H = (f r1, f r2, f t) in x and y, with -z as the divisor.
  const auto back = [&](const Vec3& column) { return Vec3(column.x() / focal, column.y() / focal, -column.z()); };
  Vec3 r1 = back(h.col(0)), r2 = back(h.col(1)), t = back(h.col(2));
  const double scale = 2 / (r1.norm() + r2.norm());
  if (t.z() > 0) r1 = -r1, r2 = -r2, t = -t;  // the rectangle is in front of the camera
  Mat3 turn;
  turn << r1, r2, r1.cross(r2);
  const Eigen::JacobiSVD<Mat3> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU() * svd.matrixV().transpose(), scale * t, focal};
}

Eigen::Matrix<double, 8, 1> misses(const Pose& pose, const Corners& ground, const Corners& seen) {
  Eigen::Matrix<double, 8, 1> miss;
  for (std::size_t k = 0; k < 4; ++k) miss.segment<2>(2 * static_cast<Eigen::Index>(k)) = pose.see(ground[k]) - seen[k];
  return miss;
}

Pose moved(const Pose& pose, const Eigen::Matrix<double, 7, 1>& step, double size) {
  Pose result = pose;
  const Vec3 turn = step.head<3>();
  if (turn.norm() > 0) result.turn = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.turn;
  result.shift += size * step.segment<3>(3);
  result.focal *= std::exp(step[6]);
  return result;
}

// Levenberg-Marquardt over turn, shift and, where it is free, focal length. Differences as derivatives: eight
// residuals.
Pose refined(Pose pose, const Corners& ground, const Corners& seen, bool focal_is_free) {
  const double size = pose.shift.norm();
  const int unknowns = focal_is_free ? 7 : 6;
  double damping = 1e-6;
  for (int round = 0; round < 60; ++round) {
    const auto miss = misses(pose, ground, seen);
    Eigen::MatrixXd jacobian(8, unknowns);
    constexpr double kStep = 1e-6;
    for (int k = 0; k < unknowns; ++k) {
      Eigen::Matrix<double, 7, 1> step = Eigen::Matrix<double, 7, 1>::Zero();
      step[k] = kStep;
      const Pose ahead = moved(pose, step, size);
      step[k] = -kStep;
      jacobian.col(k) = (misses(ahead, ground, seen) - misses(moved(pose, step, size), ground, seen)) / (2 * kStep);
    }
    Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    normal.diagonal() *= 1 + damping;
    normal.diagonal().array() += 1e-15;
    Eigen::Matrix<double, 7, 1> step = Eigen::Matrix<double, 7, 1>::Zero();
    step.head(unknowns) = -normal.ldlt().solve(jacobian.transpose() * miss);
    if (!step.allFinite()) break;
    const Pose next = moved(pose, step, size);
    if (misses(next, ground, seen).squaredNorm() < miss.squaredNorm()) {
      pose = next;
      damping = std::max(1e-12, damping / 10);
    } else {
      damping *= 10;
    }
    if (step.norm() < 1e-12) break;
  }
  return pose;
}

// Convex, and counter-clockwise as seen from above: with y up in the picture, a positive area at every corner.
bool is_seen_from_above(const Corners& corners) {
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 a = corners[(k + 1) % 4] - corners[k], b = corners[(k + 2) % 4] - corners[(k + 1) % 4];
    if (!(a.x() * b.y() - a.y() * b.x() > 1e-9)) return false;
  }
  return true;
}

// Ground x, y are the world's x, -z.
Vec3 world_from_ground(const Vec3& v) {
  return {v.x(), v.z(), -v.y()};
}

}  // namespace

PlanePose pose_from_rectangle(const PhotographedRectangle& rectangle, Size picture, std::optional<double> fov_degrees) {
  if (!(rectangle.width > 0 && rectangle.depth > 0)) throw Error("the rectangle has no size; give its width and depth");
  if (fov_degrees && !(*fov_degrees > 0 && *fov_degrees < 180)) throw Error("--fov: give degrees between 0 and 180");
  const Corners seen = centred(rectangle.corners, picture), ground = on_ground(rectangle);
  if (!is_seen_from_above(seen)) {
    throw Error(
        "the four points are no rectangle seen from above; give near left, near right, far right, far left, in pixels");
  }
  const Mat3 h = homography(ground, seen);
  std::optional<double> focal = focal_length(h);
  if (fov_degrees) focal = 1 / std::tan(0.5 * *fov_degrees * kDegree);
  if (!focal) {
    throw Error("the field of view does not follow from this rectangle, it is seen straight on; pass --fov");
  }
  const Pose pose = refined(pose_of(h, *focal), ground, seen, !fov_degrees);
  const Mat3 back = pose.turn.transpose();
  const Vec3 eye = world_from_ground(-(back * pose.shift));
  PlanePose result;
  result.camera.eye = eye.cast<float>();
  const Vec3 ahead = world_from_ground(back * Vec3(0, 0, -1));
  // To where it meets the ground, or as far as the eye is from the origin.
  const double reach = ahead.y() < -0.05 ? eye.y() / -ahead.y() : eye.norm();
  result.camera.look = (eye + reach * ahead).cast<float>();
  result.camera.up = world_from_ground(back * Vec3(0, 1, 0)).cast<float>();
  result.camera.fov_degrees = 2 * std::atan(1 / pose.focal) / kDegree;
  result.residual_px = std::sqrt(misses(pose, ground, seen).squaredNorm() / 4) * 0.5 * picture.width;
  if (!(eye.y() > 0) || !eye.allFinite()) {
    throw Error("the camera would stand below the rectangle's plane; check the order of the four points");
  }
  return result;
}

}  // namespace hdr
