#include "libhdr/probe/internal/features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/parallel.h"
#include "libhdr/probe/internal/luminance.h"

namespace hdr::internal {
namespace {

constexpr int kLongest = 2048;
constexpr int kDescriptor = 128;
constexpr float kRatio = 0.8f;  // [Lowe04]

/// Eight bits in which local contrast is alike everywhere.
cv::Mat_<std::uint8_t> codes_of(View<const float> light) {
  double sum = 0;
  std::int64_t count = 0;
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x) {
      if (!(light(x, y) > 0)) continue;
      sum += std::log(static_cast<double>(light(x, y)));
      ++count;
    }
  }
  const double middle = count > 0 ? std::exp(sum / static_cast<double>(count)) : 1;
  cv::Mat_<std::uint8_t> codes(light.height(), light.width());
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x) {
      // A third root is close to what eyes see, and to what SIFT was made on.
      codes(y, x) =
          static_cast<std::uint8_t>(std::clamp(90 * std::cbrt(static_cast<double>(light(x, y)) / middle), 0.0, 255.0));
    }
  }
  constexpr int kTilePx = 200;
  cv::createCLAHE(3, {std::max(1, light.width() / kTilePx), std::max(1, light.height() / kTilePx)})
      ->apply(codes, codes);
  return codes;
}

/// The strongest of each of 8 x 8 cells, so that borders, where photographs overlap, have their share.
std::vector<std::size_t> spread(const std::vector<cv::KeyPoint>& points, Size size, int most) {
  constexpr int kCells = 8;
  std::vector<std::vector<std::size_t>> cells(kCells * kCells);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int column = std::clamp(static_cast<int>(points[i].pt.x * kCells / size.width), 0, kCells - 1);
    const int row = std::clamp(static_cast<int>(points[i].pt.y * kCells / size.height), 0, kCells - 1);
    cells[static_cast<std::size_t>(row * kCells + column)].push_back(i);
  }
  for (auto& cell : cells) {
    std::stable_sort(cell.begin(), cell.end(),
                     [&](std::size_t a, std::size_t b) { return points[a].response > points[b].response; });
  }
  std::vector<std::size_t> chosen;
  for (std::size_t rank = 0; chosen.size() < static_cast<std::size_t>(most); ++rank) {
    const std::size_t before = chosen.size();
    for (const auto& cell : cells) {
      if (rank < cell.size() && chosen.size() < static_cast<std::size_t>(most)) chosen.push_back(cell[rank]);
    }
    if (chosen.size() == before) break;
  }
  return chosen;
}

using Descriptors =
    Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;

Descriptors matrix_of(const Image<float>& image) {
  return {image.row(0), image.height(), image.width(), Eigen::OuterStride<>(image.stride())};
}

struct Nearest {
  int index = -1;
  float best = -1, second = -1;  ///< cosines

  void see(int other, float cosine) {
    if (cosine > best) {
      second = best;
      best = cosine;
      index = other;
    } else {
      second = std::max(second, cosine);
    }
  }
  bool is_clear() const {
    return index >= 0 && 1 - best <= kRatio * kRatio * (1 - std::min(second, 1.0f));  // distances squared, halved
  }
};

}  // namespace

Features photo_features(View<const float> rgb, int most) {
  Image<float> light = luminance_of(rgb);
  double scale = 1;
  while (std::max(light.width(), light.height()) > kLongest && std::min(light.width(), light.height()) >= 2) {
    light = halved(light);
    scale *= 2;
  }
  const cv::Mat_<std::uint8_t> codes = codes_of(light);
  std::vector<cv::KeyPoint> points;
  cv::Mat found;
  cv::SIFT::create(4 * most, 3, 0.02)->detectAndCompute(codes, cv::noArray(), points, found);
  const std::vector<std::size_t> chosen = spread(points, light.size(), most);
  Features features;
  if (chosen.empty()) return features;
  features.descriptors = Image<float>(kDescriptor, static_cast<int>(chosen.size()), 1);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const cv::KeyPoint& point = points[chosen[k]];
    // OpenCV's pixel centres are at integers.
    features.px.push_back(scale * Vec2(static_cast<double>(point.pt.x) + 0.5, static_cast<double>(point.pt.y) + 0.5));
    const float* descriptor = found.ptr<float>(static_cast<int>(chosen[k]));
    float sum = 0;
    for (int i = 0; i < kDescriptor; ++i) sum += descriptor[i];
    float* row = features.descriptors.row(static_cast<int>(k));
    for (int i = 0; i < kDescriptor; ++i) row[i] = std::sqrt(descriptor[i] / std::max(sum, 1e-6f));
  }
  return features;
}

std::vector<FeaturePair> match_features(const Features& a, const Features& b) {
  std::vector<FeaturePair> matches;
  if (a.px.empty() || b.px.empty()) return matches;
  constexpr int kBlock = 256;
  std::vector<Nearest> of_a(a.px.size()), of_b(b.px.size());
  const Descriptors all_b = matrix_of(b.descriptors);
  for (int first = 0; first < static_cast<int>(a.px.size()); first += kBlock) {
    const int count = std::min(kBlock, static_cast<int>(a.px.size()) - first);
    const Eigen::MatrixXf cosines = all_b * matrix_of(a.descriptors).middleRows(first, count).transpose();
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < cosines.rows(); ++j) {
        of_a[static_cast<std::size_t>(first + i)].see(j, cosines(j, i));
        of_b[static_cast<std::size_t>(j)].see(first + i, cosines(j, i));
      }
    }
  }
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const int j = of_a[i].index;
    if (!of_a[i].is_clear() || of_b[static_cast<std::size_t>(j)].index != static_cast<int>(i)) continue;
    matches.push_back({static_cast<int>(i), j});
  }
  return matches;
}

std::vector<FeaturePair> match_near(const Features& a, const Features& b, const std::vector<Vec2>& expected,
                                    double reach) {
  constexpr float kLeastCosine = 0.75f;
  std::vector<FeaturePair> matches;
  if (a.px.empty() || b.px.empty()) return matches;
  const Descriptors of_b = matrix_of(b.descriptors), of_a = matrix_of(a.descriptors);
  std::vector<Nearest> here(a.px.size()), there(b.px.size());
  for (std::size_t i = 0; i < a.px.size(); ++i) {
    if (!expected[i].allFinite()) continue;
    for (std::size_t j = 0; j < b.px.size(); ++j) {
      if ((b.px[j] - expected[i]).squaredNorm() > reach * reach) continue;
      const float cosine = of_b.row(static_cast<int>(j)).dot(of_a.row(static_cast<int>(i)));
      here[i].see(static_cast<int>(j), cosine);
      there[j].see(static_cast<int>(i), cosine);
    }
  }
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (here[i].best < kLeastCosine || !here[i].is_clear()) continue;
    if (there[static_cast<std::size_t>(here[i].index)].index != static_cast<int>(i)) continue;
    matches.push_back({static_cast<int>(i), here[i].index});
  }
  return matches;
}

}  // namespace hdr::internal
