#include "libhdr/probe/internal/rotation_consensus.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "libhdr/core/random.h"

namespace hdr::internal {
namespace {

constexpr int kTries = 200;

/// Two directions as axes: the first, and the plane of both.
Mat3 axes_of(const Vec3& p, const Vec3& q) {
  const Vec3 across = p.cross(q).normalized();
  Mat3 axes;
  axes << p, across, p.cross(across);
  return axes;
}

/// The rotation that brings `b` nearest to `a`, least squares by the singular values [Arun87].
Mat3 rotation_of(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k].transpose();
  const Eigen::JacobiSVD<Mat3> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 flip = Mat3::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * flip * svd.matrixV().transpose();
}

/// A match counts where the chord between its rays is below `allowed`.
double score_of(const RayPairs& rays, const Mat3& a_from_b, double allowed) {
  double score = 0;
  for (std::size_t k = 0; k < rays.a.size(); ++k) {
    score += std::max(0.0, 1 - (rays.a[k] - a_from_b * rays.b[k]).squaredNorm() / (allowed * allowed));
  }
  return score;
}

}  // namespace

std::vector<std::size_t> inliers_of(const RayPairs& rays, const Mat3& a_from_b, double allowed) {
  std::vector<std::size_t> inliers;
  for (std::size_t k = 0; k < rays.a.size(); ++k) {
    if ((rays.a[k] - a_from_b * rays.b[k]).norm() < allowed) inliers.push_back(k);
  }
  return inliers;
}

Consensus consensus(const RayPairs& rays, double allowed, std::uint64_t seed) {
  Consensus best;
  const auto count = static_cast<double>(rays.a.size());
  for (int attempt = 0; attempt < kTries; ++attempt) {
    Random random(seed, 0x57, static_cast<std::uint64_t>(attempt));
    const auto i = static_cast<std::size_t>(count * random.uniform());
    const auto j = static_cast<std::size_t>(count * random.uniform());
    const double apart_a = (rays.a[i] - rays.a[j]).norm(), apart_b = (rays.b[i] - rays.b[j]).norm();
    constexpr double kLeastApart = 0.02;
    if (std::min(apart_a, apart_b) < kLeastApart || std::abs(apart_a - apart_b) > 2 * allowed) continue;
    const Mat3 a_from_b = axes_of(rays.a[i], rays.a[j]) * axes_of(rays.b[i], rays.b[j]).transpose();
    const double score = score_of(rays, a_from_b, allowed);
    if (score > best.score) best = {a_from_b, score};
  }
  for (int step = 0; step < 3 && best.score > 0; ++step) {
    std::vector<Vec3> a, b;
    for (const std::size_t k : inliers_of(rays, best.a_from_b, allowed)) {
      a.push_back(rays.a[k]);
      b.push_back(rays.b[k]);
    }
    if (a.size() < 3) break;
    const Mat3 refined = rotation_of(a, b);
    const double score = score_of(rays, refined, allowed);
    if (score <= best.score) break;
    best = {refined, score};
  }
  return best;
}

}  // namespace hdr::internal
