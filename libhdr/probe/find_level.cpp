#include "libhdr/probe/find_level.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/luminance.h"
#include "libhdr/probe/internal/sphere_lines.h"
#include "libhdr/probe/projection.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

using internal::SphereLine;

constexpr int kMostWidth = 2048;           ///< of the lat-long whose lines are looked at
constexpr double kNearest = 25 * kDegree;  ///< to a zenith, where a line's way to it is not sure

/// How far a line's way is from that to a zenith, as a share of its own deviation and what walls lean by.
struct Lean {
  double angle = 0, deviation = 1;
  bool counts = false;
};

Lean lean_of(const SphereLine& line, const Vec3& zenith, double leaning) {
  const double along = zenith.dot(line.middle), across = std::sqrt(std::max(0.0, 1 - along * along));
  if (across < std::sin(kNearest)) return {};
  const double sine = std::clamp(line.normal.dot(zenith) / across, -1.0, 1.0);
  return {std::asin(sine), std::hypot(line.deviation, leaning), true};
}

/// How much of the lines' length runs towards a zenith.
struct Support {
  double share = -1;         ///< of the length, less what would by chance
  double significance = -1;  ///< the same in deviations of what chance would give
};

Support support_of(const std::vector<SphereLine>& lines, const Vec3& zenith, double leaning) {
  double found = 0, expected = 0, variance = 0, all = 0;
  for (const SphereLine& line : lines) {
    const Lean lean = lean_of(line, zenith, leaning);
    if (!lean.counts) continue;
    const double u = lean.angle / lean.deviation;
    found += line.length * std::exp(-0.5 * u * u);
    // A way without order is anywhere in half a turn.
    const double mean = lean.deviation * std::sqrt(2 * kPi) / kPi, square = lean.deviation * std::sqrt(kPi) / kPi;
    expected += line.length * mean;
    variance += line.length * line.length * std::max(0.0, square - mean * mean);
    all += line.length;
  }
  if (!(all > 0)) return {};
  return {(found - expected) / all, (found - expected) / std::sqrt(variance)};
}

Vec3 tilted(double right, double front) {
  return Vec3(-std::sin(right), 1, std::sin(front)).normalized();
}

struct Zenith {
  Vec3 dir = Vec3::UnitY();
  Support support{};
};

constexpr double kLean = 0.5 * kDegree;  ///< of walls and trunks

/// All over the cap, then uphill.
Zenith best_zenith(const std::vector<SphereLine>& lines) {
  constexpr double kMost = 40, kStep = 1.25, kWide = 1.5 * kDegree;
  constexpr int kCells = static_cast<int>(kMost / kStep);
  std::vector<Zenith> rows(2 * kCells + 1);
  const auto less = [](const Zenith& a, const Zenith& b) { return a.support.share < b.support.share; };
  for_rows(2 * kCells + 1, 1, [&](int first, int last) {
    for (int j = first; j < last; ++j) {
      for (int i = -kCells; i <= kCells; ++i) {
        if (std::hypot(i, j - kCells) > kCells) continue;
        const Vec3 dir = tilted(i * kStep * kDegree, (j - kCells) * kStep * kDegree);
        const Zenith zenith{dir, support_of(lines, dir, kWide)};
        Zenith& row = rows[static_cast<std::size_t>(j)];
        if (less(row, zenith)) row = zenith;
      }
    }
  });
  Zenith best = *std::max_element(rows.begin(), rows.end(), less);
  for (double leaning = kWide, move = 0.8 * kDegree; move > 0.005 * kDegree; move *= 0.5) {
    leaning = std::max(kLean, 0.7 * leaning);
    best.support = support_of(lines, best.dir, leaning);
    for (bool moved = true; moved;) {
      moved = false;
      for (const Vec3& by : {Vec3(move, 0, 0), Vec3(-move, 0, 0), Vec3(0, 0, move), Vec3(0, 0, -move)}) {
        const Vec3 dir = (best.dir + by).normalized();
        const Zenith zenith{dir, support_of(lines, dir, leaning)};
        if (!less(best, zenith)) continue;
        best = zenith;
        moved = true;
      }
    }
  }
  return best;
}

/// How sure a zenith is, radians: the sandwich of the weighted equations' matrix and of what their residuals really
/// are [Huber67].
double deviation_of(const std::vector<SphereLine>& lines, const Vec3& zenith) {
  const Vec3 a = zenith.unitOrthogonal(), b = zenith.cross(a);
  Eigen::Matrix2d bread = Eigen::Matrix2d::Zero(), meat = bread;
  for (const SphereLine& line : lines) {
    const Lean lean = lean_of(line, zenith, kLean);
    if (!lean.counts) continue;
    const double u = lean.angle / lean.deviation;
    const double weight = line.length * std::exp(-0.5 * u * u) / (lean.deviation * lean.deviation);
    const double along = zenith.dot(line.middle);
    const Eigen::Vector2d row = Eigen::Vector2d(line.normal.dot(a), line.normal.dot(b)) / std::sqrt(1 - along * along);
    bread += weight * (1 - u * u) * row * row.transpose();
    meat += weight * weight * lean.angle * lean.angle * row * row.transpose();
  }
  if (!(bread.determinant() > 0) || !(bread.trace() > 0)) return kPi;
  const Eigen::Matrix2d inverse = bread.inverse();
  return std::min(kPi, std::sqrt((inverse * meat * inverse).trace()));
}

Mat3 upright(const Vec3& zenith) {
  return Eigen::Quaterniond::FromTwoVectors(zenith, Vec3::UnitY()).toRotationMatrix();
}

}  // namespace

std::optional<FoundLevel> find_level(View<const float> latlong, View<const float> shown) {
  // Waves without order come to 8.5 by their long crests, eleven real places to 14 or more, two without lines to 1.3.
  constexpr double kLeastSignificance = 10;
  constexpr std::size_t kFewestLines = 12;
  const int width = std::min(kMostWidth, latlong.width());
  const Size size{width, width / 2};
  const LatLong from{latlong.size()}, to{size};
  const Image<float> light = resample(internal::luminance_of(latlong), from, to, size);
  const Image<float> seen = shown.empty() ? Image<float>() : resample(shown, from, to, size);
  const std::vector<SphereLine> lines = internal::lines_on_sphere(light, seen);
  if (lines.size() < kFewestLines) return std::nullopt;
  const Zenith zenith = best_zenith(lines);
  if (zenith.support.significance < kLeastSignificance) return std::nullopt;
  return FoundLevel{upright(zenith.dir), std::acos(std::clamp(zenith.dir.y(), -1.0, 1.0)) / kDegree,
                    zenith.support.share, deviation_of(lines, zenith.dir) / kDegree};
}

Mat3 level_from_horizon(const std::vector<Vec3>& on_horizon) {
  constexpr double kLeastApart = 1e-3, kSteepest = 0.5;
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& dir : on_horizon) scatter += dir * dir.transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(scatter);
  if (on_horizon.size() < 2 || axes.eigenvalues()[1] < kLeastApart) {
    throw Error("--horizon: give two or more points of the true horizon, best a quarter of a turn apart");
  }
  Vec3 zenith = axes.eigenvectors().col(0);
  if (zenith.y() < 0) zenith = -zenith;
  if (zenith.y() < kSteepest) throw Error("--horizon: these points make a horizon steeper than 60 degrees");
  return upright(zenith);
}

}  // namespace hdr
