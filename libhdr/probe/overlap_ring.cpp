#include "libhdr/probe/internal/overlap_ring.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/source_picture.h"

namespace hdr::internal {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// Eight bits in which local contrast is alike everywhere, and where there is anything at all.
struct Codes {
  cv::Mat_<std::uint8_t> grey, shown;
};

Codes codes_of(View<const float> ring) {
  Codes codes{cv::Mat_<std::uint8_t>(ring.height(), ring.width()), cv::Mat_<std::uint8_t>(ring.height(), ring.width())};
  double sum = 0;
  int count = 0;
  for (int y = 0; y < ring.height(); ++y) {
    for (int x = 0; x < ring.width(); ++x) {
      const float* p = ring.pixel(x, y);
      if (p[0] != p[0]) continue;
      sum += std::log(std::max(1e-6, luminance<double>(p[0], p[1], p[2])));
      ++count;
    }
  }
  const double middle = count > 0 ? std::exp(sum / count) : 1;
  for (int y = 0; y < ring.height(); ++y) {
    for (int x = 0; x < ring.width(); ++x) {
      const float* p = ring.pixel(x, y);
      const bool shown = p[0] == p[0];
      const double light = shown ? luminance<double>(p[0], p[1], p[2]) / middle : 1;
      // A third root is close to what eyes see, and to what SIFT was made on.
      codes.grey(y, x) = static_cast<std::uint8_t>(std::clamp(90 * std::cbrt(std::max(0.0, light)), 0.0, 255.0));
      codes.shown(y, x) = shown ? 255 : 0;
    }
  }
  cv::createCLAHE(3, {std::max(1, ring.width() / 160), 1})->apply(codes.grey, codes.grey);
  // Features do not sit on the edge of what is shown.
  cv::erode(codes.shown, codes.shown, cv::getStructuringElement(cv::MORPH_RECT, {9, 9}), {-1, -1}, 1,
            cv::BORDER_CONSTANT, 0);
  return codes;
}

struct Features {
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
};

Features features_of(const Codes& codes) {
  Features features;
  const auto sift = cv::SIFT::create(8000, 3, 0.02);
  sift->detectAndCompute(codes.grey, codes.shown, features.points, features.descriptors);
  return features;
}

Eigen::Map<const Eigen::Matrix<float, 128, 1>> descriptor(const Features& features, int k) {
  return Eigen::Map<const Eigen::Matrix<float, 128, 1>>(features.descriptors.ptr<float>(k));
}

/// For each feature of `a` the one of `b` within reach that is most like it, if the next is clearly less so; -1: none.
std::vector<int> nearest(const Features& a, const Features& b, const Ring& ring, double reach) {
  constexpr float kRatio = 0.8f;  // [Lowe04]
  const double most_x = reach * ring.width / (2 * kPi), most_y = most_x;
  std::vector<int> result(a.points.size(), -1);
  for_rows(static_cast<int>(a.points.size()), 64, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const auto& p = a.points[static_cast<std::size_t>(i)].pt;
      float best = std::numeric_limits<float>::max(), second = best;  // distances squared
      for (std::size_t j = 0; j < b.points.size(); ++j) {
        const auto& q = b.points[j].pt;
        const double apart = std::abs(1.0 * (p.x - q.x));
        if (std::min(apart, ring.width - apart) > most_x || std::abs(p.y - q.y) > most_y) {
          continue;
        }
        const float distance = (descriptor(a, i) - descriptor(b, static_cast<int>(j))).squaredNorm();
        if (distance < best) {
          second = best;
          best = distance;
          result[static_cast<std::size_t>(i)] = static_cast<int>(j);
        } else {
          second = std::min(second, distance);
        }
      }
      if (best > kRatio * kRatio * second) result[static_cast<std::size_t>(i)] = -1;
    }
  });
  return result;
}

}  // namespace

Vec3 Ring::dir_at(double column, double row) const {
  const double azimuth = 2 * kPi * column / width, angle = angle_of_row(row);
  return {-std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)};
}

Vec2 Ring::px_of(const Vec3& dir) const {
  const double azimuth = std::atan2(dir.y(), -dir.x()), angle = std::atan2(std::hypot(dir.x(), dir.y()), dir.z());
  const double column = azimuth / (2 * kPi) * width;
  return {column < 0 ? column + width : column, (angle - first_angle) / (last_angle - first_angle) * height};
}

Ring ring_of(const PairView& front, const PairView& back, double pixels_per_radian, double margin) {
  // The back lens's axis may lean: the ring is what both see at some azimuth, and unroll() says where.
  const double lean = std::acos(std::clamp(-(back.probe_from_view * Vec3::UnitZ()).z(), -1.0, 1.0));
  Ring ring;
  ring.first_angle = kPi - 0.5 * back.lens.fov_degrees * kDegree - lean - margin;
  ring.last_angle = std::min(kPi, 0.5 * front.lens.fov_degrees * kDegree + margin);
  ring.width = 4 * static_cast<int>(std::lround(0.25 * 2 * kPi * pixels_per_radian));
  const double height = (ring.last_angle - ring.first_angle) * pixels_per_radian;
  ring.height = height > 8 && ring.first_angle > 0 ? static_cast<int>(std::ceil(height)) : 0;
  return ring;
}

Image<float> unroll(View<const float> photograph, const PairView& view, const Ring& ring) {
  const SourcePicture source(photograph, view.lens);
  const Mat3 view_from_probe = view.probe_from_view.transpose();
  const int channels = photograph.channels();
  Image<float> unrolled(ring.width, ring.height, channels);
  for_rows(ring.height, 8, [&](int first, int last) {
    std::vector<double> sum(static_cast<std::size_t>(channels));
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < ring.width; ++x) {
        float* out = unrolled.pixel(x, y);
        const auto px = view.lens.px_from_dir(view_from_probe * ring.dir_at(x + 0.5, y + 0.5));
        if (!px || !source.contains(*px)) {
          std::fill(out, out + channels, kNothing);
          continue;
        }
        std::fill(sum.begin(), sum.end(), 0.0);
        source.add(*px, sum.data());
        for (int c = 0; c < channels; ++c) {
          out[c] = static_cast<float>(view.gain * sum[static_cast<std::size_t>(c)]);
        }
      }
    }
  });
  return unrolled;
}

std::vector<Match> match_rings(View<const float> front, View<const float> back, const Ring& ring, const PairView& a,
                               const PairView& b, double reach) {
  const Features in_front = features_of(codes_of(front)), in_back = features_of(codes_of(back));
  std::vector<Match> matches;
  if (in_front.points.empty() || in_back.points.empty()) return matches;
  const std::vector<int> there = nearest(in_front, in_back, ring, reach),
                         here = nearest(in_back, in_front, ring, reach);
  for (std::size_t i = 0; i < there.size(); ++i) {
    if (there[i] < 0 || here[static_cast<std::size_t>(there[i])] != static_cast<int>(i)) continue;
    const auto dir_of = [&](const cv::KeyPoint& k) {  // OpenCV's pixel centres are at integers
      return ring.dir_at(k.pt.x + 0.5, k.pt.y + 0.5);
    };
    const Vec3 d = dir_of(in_front.points[i]), e = dir_of(in_back.points[static_cast<std::size_t>(there[i])]);
    const auto p = a.lens.px_from_dir(a.probe_from_view.transpose() * d);
    const auto q = b.lens.px_from_dir(b.probe_from_view.transpose() * e);
    if (p && q) matches.push_back({*p, *q, (d + e).normalized()});
  }
  return matches;
}

std::vector<double> best_seam(View<const float> front, View<const float> back) {
  const int width = front.width(), height = front.height();
  constexpr double kNoOverlap = 1e3;  // a seam leaves the ring that both show only where there is no other way
  Image<float> cost(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double difference = kNoOverlap;
      const float *p = front.pixel(x, y), *q = back.pixel(x, y);
      if (p[0] == p[0] && q[0] == q[0]) {
        difference = 0;
        for (int c = 0; c < 3; ++c)
          difference += std::abs(static_cast<double>(p[c] - q[c])) / (1e-6 + std::abs(p[c]) + std::abs(q[c]));
      }
      // A little dearer away from the middle, where each lens is blurred.
      const double aside = (y + 0.5) / height - 0.5;
      cost(x, y) = static_cast<float>(difference + 0.1 * aside * aside);
    }
  }
  // A path once around that ends where it began: begun where the cheapest open one begins.
  const auto path_from = [&](int start) {
    std::vector<float> reach(static_cast<std::size_t>(height), std::numeric_limits<float>::max());
    for (int y = 0; y < height; ++y) {
      if (start < 0 || y == start) reach[static_cast<std::size_t>(y)] = cost(0, y);
    }
    Image<std::int32_t> from(width, height, 1);
    for (int x = 1; x < width; ++x) {
      std::vector<float> next(reach.size());
      for (int y = 0; y < height; ++y) {
        int best = y;
        for (const int z : {y - 1, y + 1}) {
          if (z >= 0 && z < height && reach[static_cast<std::size_t>(z)] < reach[static_cast<std::size_t>(best)])
            best = z;
        }
        from(x, y) = best;
        next[static_cast<std::size_t>(y)] = reach[static_cast<std::size_t>(best)] + cost(x, y);
      }
      reach = std::move(next);
    }
    int y = start >= 0 ? start : static_cast<int>(std::min_element(reach.begin(), reach.end()) - reach.begin());
    std::vector<int> rows(static_cast<std::size_t>(width));
    for (int x = width - 1; x >= 0; --x) {
      rows[static_cast<std::size_t>(x)] = y;
      y = x > 0 ? from(x, y) : y;
    }
    return rows;
  };
  const std::vector<int> rows = path_from(path_from(-1).front());
  std::vector<double> seam(rows.size());
  for (std::size_t x = 0; x < rows.size(); ++x) seam[x] = rows[x] + 0.5;
  return seam;
}

}  // namespace hdr::internal
