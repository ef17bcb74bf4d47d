#include "libhdr/probe/find_level.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/luminance.h"
#include "libhdr/probe/projection.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

constexpr int kWidth = 1024;  ///< of the lat-long whose edges are looked at

/// Something long and narrow at `dir`, across which light changes along `normal` (unit, perpendicular to dir).
struct Edge {
  Vec3 dir, normal;
  double weight;
};

Image<float> log_light(View<const float> light) {
  std::vector<float> values;
  for (int y = 0; y < light.height(); y += 2) {
    for (int x = 0; x < light.width(); x += 2) values.push_back(light(x, y));
  }
  constexpr float kShare = 0.05f;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const float floor = std::max(1e-30f, kShare * *middle);
  Image<float> logs(light.size(), 1);
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x) logs(x, y) = std::log(std::max(0.0f, light(x, y)) + floor);
  }
  return logs;
}

/// Blurred by 1.4 pixels: the steps of a slanted edge's pixels are edges along rows and columns themselves.
Image<float> blurred(Image<float> map) {
  constexpr int kTimes = 2;
  constexpr float kTaps[5] = {1 / 16.0f, 4 / 16.0f, 6 / 16.0f, 4 / 16.0f, 1 / 16.0f};
  const int width = map.width(), height = map.height();
  for (int pass = 0; pass < kTimes; ++pass) {
    Image<float> across(map.size(), 1), both(map.size(), 1);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int k = -2; k <= 2; ++k) across(x, y) += kTaps[k + 2] * map((x + k + width) % width, y);
      }
    }
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int k = -2; k <= 2; ++k) both(x, y) += kTaps[k + 2] * across(x, std::clamp(y + k, 0, height - 1));
      }
    }
    map = std::move(both);
  }
  return map;
}

/// Edges of a lat-long, the third with the steepest light; a steeper one does not count for more than their median.
std::vector<Edge> edges_of(const Image<float>& logs, View<const float> shown) {
  constexpr double kHighest = 70 * kDegree;  // beyond, columns are too close together
  const int width = logs.width(), height = logs.height();
  std::vector<Edge> edges;
  std::vector<double> slopes;
  for (int y = 1; y + 1 < height; ++y) {
    const double elevation = kPi * (0.5 - (y + 0.5) / height);
    if (std::abs(elevation) > kHighest) continue;
    for (int x = 0; x < width; ++x) {
      const int left = (x + width - 1) % width, right = (x + 1) % width;
      const auto seen = [&](int i, int j) { return shown.empty() || shown(i, j) > 0.99f; };
      if (!seen(left, y - 1) || !seen(right, y - 1) || !seen(left, y + 1) || !seen(right, y + 1)) continue;
      // [Scharr00]: right to a degree whichever way the edge runs.
      const auto across = [&](int row) { return static_cast<double>(logs(right, row) - logs(left, row)); };
      const auto down = [&](int column) { return static_cast<double>(logs(column, y + 1) - logs(column, y - 1)); };
      const double gx = (3 * across(y - 1) + 10 * across(y) + 3 * across(y + 1)) / (16 * std::cos(elevation));
      const double gy = (3 * down(left) + 10 * down(x) + 3 * down(right)) / 16;
      const double slope = std::hypot(gx, gy);
      constexpr double kLeast = 1e-3;  // of ln: less is rounding
      if (!(slope > kLeast)) continue;
      const Vec3 dir = dir_from_latlong((x + 0.5) / width, (y + 0.5) / height);
      const Vec3 east = Vec3(-dir.z(), 0, dir.x()).normalized();  // image right
      const Vec3 south = -(Vec3::UnitY() - dir.y() * dir).normalized();
      edges.push_back({dir, (gx * east + gy * south) / slope, slope * std::cos(elevation)});
      slopes.push_back(slope);
    }
  }
  if (edges.empty()) return edges;
  const auto quantile = [&](double q) {
    const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(slopes.size() - 1));
    std::nth_element(slopes.begin(), slopes.begin() + k, slopes.end());
    return slopes[static_cast<std::size_t>(k)];
  };
  const double least = quantile(0.67), most = quantile(0.83);
  std::vector<Edge> steep;
  for (Edge& edge : edges) {
    const double level = std::hypot(edge.dir.x(), edge.dir.z()), slope = edge.weight / level;
    if (slope < least) continue;
    edge.weight = level * std::min(slope, most) / most;
    steep.push_back(edge);
  }
  return steep;
}

/// Share of the edges' weight that runs towards a zenith within about `width` (radians), less what would by chance.
double support_of(const std::vector<Edge>& edges, const Vec3& zenith, double width, std::size_t step = 1) {
  constexpr double kNearZenith = 0.9;
  double vertical = 0, all = 0;
  for (std::size_t k = 0; k < edges.size(); k += step) {
    const Edge& edge = edges[k];
    const double along = zenith.dot(edge.dir);
    if (std::abs(along) > kNearZenith) continue;
    const double off2 = std::pow(zenith.dot(edge.normal), 2) / (1 - along * along);  // sin^2 of the angle between
    vertical += edge.weight * std::exp(-0.5 * off2 / (width * width));
    all += edge.weight;
  }
  const double by_chance = width * std::sqrt(2 * kPi) / kPi;
  return all > 0 ? vertical / all - by_chance : 0;
}

Vec3 tilted(double right, double front) {
  return Vec3(-std::sin(right), 1, std::sin(front)).normalized();
}

struct Zenith {
  Vec3 dir = Vec3::UnitY();
  double support = -1;
};

/// All over the cap, then uphill.
Zenith best_zenith(const std::vector<Edge>& edges) {
  constexpr double kMost = 40, kStep = 1.5, kWide = 2.5 * kDegree;
  constexpr int kCells = static_cast<int>(kMost / kStep);
  constexpr std::size_t kSome = 20000;
  const std::size_t step = std::max<std::size_t>(1, edges.size() / kSome);
  std::vector<Zenith> rows(2 * kCells + 1);
  for_rows(2 * kCells + 1, 1, [&](int first, int last) {
    for (int j = first; j < last; ++j) {
      for (int i = -kCells; i <= kCells; ++i) {
        if (std::hypot(i, j - kCells) > kCells) continue;
        const Vec3 dir = tilted(i * kStep * kDegree, (j - kCells) * kStep * kDegree);
        const double support = support_of(edges, dir, kWide, step);
        Zenith& row = rows[static_cast<std::size_t>(j)];
        if (support > row.support) row = {dir, support};
      }
    }
  });
  Zenith best = *std::max_element(rows.begin(), rows.end(),
                                  [](const Zenith& a, const Zenith& b) { return a.support < b.support; });
  for (double width = kWide, move = 1.0 * kDegree; move > 0.01 * kDegree; move *= 0.5) {
    width = std::max(0.8 * kDegree, 0.7 * width);
    best.support = support_of(edges, best.dir, width);
    for (bool moved = true; moved;) {
      moved = false;
      for (const Vec3& by : {Vec3(move, 0, 0), Vec3(-move, 0, 0), Vec3(0, 0, move), Vec3(0, 0, -move)}) {
        const Vec3 dir = (best.dir + by).normalized();
        const double support = support_of(edges, dir, width);
        if (support <= best.support) continue;
        best = {dir, support};
        moved = true;
      }
    }
  }
  return best;
}

Mat3 upright(const Vec3& zenith) {
  return Eigen::Quaterniond::FromTwoVectors(zenith, Vec3::UnitY()).toRotationMatrix();
}

}  // namespace

std::optional<FoundLevel> find_level(View<const float> latlong, View<const float> shown) {
  constexpr double kLeastSupport = 0.04;
  constexpr std::size_t kLeastEdges = 500;
  const Size size{kWidth, kWidth / 2};
  const LatLong from{latlong.size()}, to{size};
  const Image<float> light = resample(internal::luminance_of(latlong), from, to, size);
  const Image<float> seen = shown.empty() ? Image<float>() : resample(shown, from, to, size);
  const std::vector<Edge> edges = edges_of(blurred(log_light(light)), seen);
  if (edges.size() < kLeastEdges) return std::nullopt;
  const Zenith zenith = best_zenith(edges);
  if (zenith.support < kLeastSupport) return std::nullopt;
  return FoundLevel{upright(zenith.dir), std::acos(std::clamp(zenith.dir.y(), -1.0, 1.0)) / kDegree, zenith.support};
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
