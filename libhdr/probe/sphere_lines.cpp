#include "libhdr/probe/internal/sphere_lines.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

constexpr double kHighest = 75 * kDegree;  ///< beyond, the columns of a lat-long are too close together

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

/// Blurred by a pixel: the steps of a slanted edge's pixels are edges along rows and columns themselves.
Image<float> blurred(const Image<float>& map) {
  constexpr float kTaps[5] = {1 / 16.0f, 4 / 16.0f, 6 / 16.0f, 4 / 16.0f, 1 / 16.0f};
  const int width = map.width(), height = map.height();
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
  return both;
}

/// How light changes at each pixel: the normal of the plane whose line would change it so, and how steeply, ln a row.
struct Slopes {
  Size size;
  std::vector<Vec3> normal;
  std::vector<float> steepness;  ///< 0: not to be used

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
  }
};

Slopes slopes_of(const Image<float>& logs, View<const float> shown) {
  const int width = logs.width(), height = logs.height();
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  Slopes slopes{logs.size(), std::vector<Vec3>(count, Vec3::Zero()), std::vector<float>(count, 0.0f)};
  for_rows(height, 8, [&](int first, int last) {
    for (int y = std::max(1, first); y < std::min(last, height - 1); ++y) {
      const double elevation = kPi * (0.5 - (y + 0.5) / height);
      if (std::abs(elevation) > kHighest) continue;
      for (int x = 0; x < width; ++x) {
        const int left = (x + width - 1) % width, right = (x + 1) % width;
        const auto seen = [&](int i, int j) { return shown.empty() || shown(i, j) > 0.99f; };
        if (!seen(left, y - 1) || !seen(right, y - 1) || !seen(left, y + 1) || !seen(right, y + 1)) continue;
        // [Scharr00]: right to a degree whichever way the edge runs.
        const auto across = [&](int row) { return static_cast<double>(logs(right, row) - logs(left, row)); };
        const auto down = [&](int column) { return static_cast<double>(logs(column, y + 1) - logs(column, y - 1)); };
        const double gx = (3 * across(y - 1) + 10 * across(y) + 3 * across(y + 1)) / (32 * std::cos(elevation));
        const double gy = (3 * down(left) + 10 * down(x) + 3 * down(right)) / 32;
        const double slope = std::hypot(gx, gy);
        if (!(slope > 0) || !std::isfinite(slope)) continue;
        const Vec3 dir = dir_from_latlong((x + 0.5) / width, (y + 0.5) / height);
        const Vec3 east = Vec3(-dir.z(), 0, dir.x()).normalized();  // image right
        const Vec3 south = -(Vec3::UnitY() - dir.y() * dir).normalized();
        slopes.normal[slopes.at(x, y)] = (gx * east + gy * south) / slope;
        slopes.steepness[slopes.at(x, y)] = static_cast<float>(slope);
      }
    }
  });
  return slopes;
}

struct Pixel {
  int x, y;
};

/// The line that a region of pixels is, if it is one. `pixel`: radians a row.
bool fitted(const Slopes& slopes, const std::vector<Pixel>& region, double pixel, SphereLine& line) {
  constexpr double kShortest = 10, kWidest = 1.8;  // pixels; an edge's ramp after the blur has a deviation of one
  Mat3 scatter = Mat3::Zero();
  double total = 0;
  std::vector<Vec3> dirs;
  std::vector<double> weights;
  for (const Pixel& p : region) {
    dirs.push_back(dir_from_latlong((p.x + 0.5) / slopes.size.width, (p.y + 0.5) / slopes.size.height));
    // A row's pixels are closer together towards the poles.
    weights.push_back(static_cast<double>(slopes.steepness[slopes.at(p.x, p.y)]) *
                      std::hypot(dirs.back().x(), dirs.back().z()));
    scatter += weights.back() * dirs.back() * dirs.back().transpose();
    total += weights.back();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(scatter);
  line.normal = axes.eigenvectors().col(0);
  line.middle = axes.eigenvectors().col(2);
  if (line.middle.dot(dirs.front()) < 0) line.middle = -line.middle;
  const Vec3 along = line.normal.cross(line.middle);
  double first = 0, last = 0;
  for (const Vec3& dir : dirs) {
    const double t = std::atan2(dir.dot(along), dir.dot(line.middle));
    first = std::min(first, t);
    last = std::max(last, t);
  }
  line.length = last - first;
  const double width = std::sqrt(std::max(0.0, axes.eigenvalues()[0]) / total);
  const double spread = std::sqrt(std::max(1e-30, axes.eigenvalues()[1]) / total);
  // Across its ramp each row of pixels says where the edge is to a fraction of a pixel.
  constexpr double kPlace = 0.35;
  const double rows = std::max(1.0, line.length / pixel);
  line.deviation = kPlace * pixel / (spread * std::sqrt(rows));
  return line.length >= kShortest * pixel && width <= kWidest * pixel;
}

/// Grows regions of one normal over steep pixels that lie side by side.
class Grower {
 public:
  Grower(const Slopes& slopes, float least) : slopes_(slopes), least_(least), used_(slopes.steepness.size(), 0) {}

  std::vector<Pixel> region_from(const Pixel& seed) {
    const double alike = std::cos(kAlike);
    std::vector<Pixel> region;
    if (used_[slopes_.at(seed.x, seed.y)]) return region;
    Vec3 sum = Vec3::Zero();
    const auto take = [&](const Pixel& p) {
      const std::size_t at = slopes_.at(p.x, p.y);
      used_[at] = 1;
      sum += static_cast<double>(slopes_.steepness[at]) * slopes_.normal[at];
      region.push_back(p);
    };
    take(seed);
    const int width = slopes_.size.width, height = slopes_.size.height;
    for (std::size_t k = 0; k < region.size(); ++k) {
      const Pixel p = region[k];
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const Pixel beside{(p.x + dx + width) % width, p.y + dy};
          if (beside.y < 0 || beside.y >= height) continue;
          const std::size_t at = slopes_.at(beside.x, beside.y);
          if (used_[at] || slopes_.steepness[at] < least_) continue;
          if (slopes_.normal[at].dot(sum) >= alike * sum.norm()) take(beside);
        }
      }
    }
    return region;
  }

 private:
  static constexpr double kAlike = 12 * kDegree;
  const Slopes& slopes_;
  float least_;
  std::vector<std::uint8_t> used_;
};

}  // namespace

std::vector<SphereLine> lines_on_sphere(View<const float> latlong, View<const float> shown) {
  constexpr double kSteep = 0.6;    // quantile of the slopes from which on they may be lines
  constexpr float kLeast = 0.004f;  // ln a pixel: less is rounding
  const Slopes slopes = slopes_of(blurred(log_light(latlong)), shown);
  std::vector<Pixel> order;
  std::vector<float> steep;
  for (int y = 0; y < slopes.size.height; ++y) {
    for (int x = 0; x < slopes.size.width; ++x) {
      const float s = slopes.steepness[slopes.at(x, y)];
      if (s <= 0) continue;
      order.push_back({x, y});
      steep.push_back(s);
    }
  }
  if (order.empty()) return {};
  const auto k = static_cast<std::ptrdiff_t>(kSteep * static_cast<double>(steep.size() - 1));
  std::nth_element(steep.begin(), steep.begin() + k, steep.end());
  const float least = std::max(kLeast, steep[static_cast<std::size_t>(k)]);
  const auto steepness = [&](const Pixel& p) { return slopes.steepness[slopes.at(p.x, p.y)]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](const Pixel& a, const Pixel& b) { return steepness(a) > steepness(b); });
  Grower grower(slopes, least);
  std::vector<SphereLine> lines;
  for (const Pixel& seed : order) {
    if (steepness(seed) < least) break;
    const std::vector<Pixel> region = grower.region_from(seed);
    constexpr std::size_t kFewest = 10;
    if (region.size() < kFewest) continue;
    SphereLine line;
    if (fitted(slopes, region, kPi / slopes.size.height, line)) lines.push_back(line);
  }
  return lines;
}

}  // namespace hdr::internal
