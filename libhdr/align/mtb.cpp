// Median threshold bitmaps [Ward03]: a shot's pixels above its median are nearly the same pixels at any exposure.
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "libhdr/align/internal/pair.h"
#include "libhdr/core/internal/opencv.h"

namespace hdr::internal {
namespace {

constexpr int kExclusion = 4;  // grey levels around the median that noise may carry across it [Ward03]

/// [Ward03] sec. 2.1: grey = (54 R + 183 G + 19 B) / 256, here of 8 bits.
cv::Mat grey_of(const Photo& photo) {
  cv::Mat grey(photo.height(), photo.width(), CV_8U);
  const int shift = std::max(0, photo.bits - 8);
  std::visit(
      [&](const auto& codes) {
        for (int y = 0; y < grey.rows; ++y) {
          for (int x = 0; x < grey.cols; ++x) {
            const auto* p = codes.pixel(x, y);
            grey.at<std::uint8_t>(y, x) =
                static_cast<std::uint8_t>(((54 * p[0] + 183 * p[1] + 19 * p[2]) >> 8) >> shift);
          }
        }
      },
      photo.codes);
  return grey;
}

/// The code below which `share` of the pixels lie.
int percentile(const cv::Mat& grey, double share) {
  std::array<int, 256> histogram{};
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) ++histogram[grey.at<std::uint8_t>(y, x)];
  }
  double left = share * static_cast<double>(grey.total());
  int code = 0;
  while (code < 255 && left >= histogram[static_cast<std::size_t>(code)]) {
    left -= histogram[static_cast<std::size_t>(code++)];
  }
  return code;
}

/// The share at which both shots have a usable threshold: their medians, or, where one is all but black or white, the
/// percentile nearest to it that is neither in either.
std::optional<double> common_share(const cv::Mat& a, const cv::Mat& b) {
  for (const double share : {0.5, 0.67, 0.33, 0.8, 0.2, 0.9, 0.1, 0.97, 0.03}) {
    const auto usable = [](int code) { return code > 10 && code < 245; };
    if (usable(percentile(a, share)) && usable(percentile(b, share))) return share;
  }
  return std::nullopt;
}

struct Bitmap {
  cv::Mat above, certain;  ///< over the threshold; far enough from it to count
};

Bitmap bitmap_of(const cv::Mat& grey, int threshold) {
  Bitmap bitmap;
  cv::compare(grey, threshold, bitmap.above, cv::CMP_GT);
  cv::Mat distance;
  cv::absdiff(grey, cv::Scalar(threshold), distance);
  cv::compare(distance, kExclusion, bitmap.certain, cv::CMP_GT);
  return bitmap;
}

/// Share of the certain pixels of the overlap on which the bitmaps differ when b is read at x + d.
double difference(const Bitmap& a, const Bitmap& b, int dx, int dy) {
  const cv::Rect all(0, 0, a.above.cols, a.above.rows);
  const cv::Rect in_a = all & (all - cv::Point(dx, dy));
  if (in_a.empty()) return 1;
  const cv::Rect in_b = in_a + cv::Point(dx, dy);
  cv::Mat certain, wrong;
  cv::bitwise_and(a.certain(in_a), b.certain(in_b), certain);
  cv::bitwise_xor(a.above(in_a), b.above(in_b), wrong);
  cv::bitwise_and(wrong, certain, wrong);
  const int counted = cv::countNonZero(certain);
  return counted > 0 ? static_cast<double>(cv::countNonZero(wrong)) / counted : 1;
}

}  // namespace

PairMotion mtb_shift(const Photo& a, const Photo& b) {
  std::vector<cv::Mat> grey_a{grey_of(a)}, grey_b{grey_of(b)};
  const std::optional<double> share = common_share(grey_a[0], grey_b[0]);
  if (!share) return failed("no grey level divides both it and its neighbour");
  constexpr int kSmallestSide = 32;
  constexpr std::size_t kMostLevels = 7;
  while (grey_a.size() < kMostLevels && std::min(grey_a.back().cols, grey_a.back().rows) >= 2 * kSmallestSide) {
    for (auto* pyramid : {&grey_a, &grey_b}) {
      cv::Mat half;
      cv::resize(pyramid->back(), half, cv::Size(pyramid->back().cols / 2, pyramid->back().rows / 2), 0, 0,
                 cv::INTER_AREA);
      pyramid->push_back(half);
    }
  }
  // From the smallest level up: double the shift, then the best of the nine around it.
  int x = 0, y = 0;
  double best = 1, still = 1;
  for (std::size_t level = grey_a.size(); level-- > 0;) {
    const Bitmap in_a = bitmap_of(grey_a[level], percentile(grey_a[level], *share));
    const Bitmap in_b = bitmap_of(grey_b[level], percentile(grey_b[level], *share));
    const int from_x = 2 * x, from_y = 2 * y;
    x = from_x;
    y = from_y;
    best = difference(in_a, in_b, x, y);
    for (int k = 0; k < 9; ++k) {
      const int u = from_x + k % 3 - 1, v = from_y + k / 3 - 1;
      const double d = difference(in_a, in_b, u, v);
      if (d >= best) continue;
      best = d;
      x = u;
      y = v;
    }
    still = difference(in_a, in_b, 0, 0);
  }
  if (best >= 0.5 || best > still) return failed("moving it would not match its neighbour better");
  return shift_motion(a.size(), Vec2(x, y), Mat2::Identity() / 12);  // the rounding to whole pixels
}

}  // namespace hdr::internal
