#include "libhdr/probe/test_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

/// A text on a square that touches the sphere at `front`, `half_width` wide to each side (the sphere's radius is 1).
class Label {
 public:
  Label(const std::string& text, const Vec3& front, const Vec3& up, double half_width)
      : front_(front), up_(up), right_(front.cross(up)), half_width_(half_width), ink_(kPixels, kPixels) {
    constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
    constexpr int kThickness = 12;
    ink_ = 0;
    int below = 0;
    const cv::Size unit = cv::getTextSize(text, kFont, 1, 1, &below);
    const double scale = std::min(0.85 * kPixels / unit.width, 0.7 * kPixels / unit.height);
    const cv::Size size = cv::getTextSize(text, kFont, scale, kThickness, &below);
    cv::putText(ink_, text, {(kPixels - size.width) / 2, (kPixels + size.height) / 2}, kFont, scale, 255, kThickness,
                cv::LINE_AA);
  }

  /// How much ink a direction meets, 0..1.
  double at(const Vec3& dir) const {
    const double depth = dir.dot(front_);
    if (depth < 0.5) return 0;
    const double x = (dir.dot(right_) / depth / half_width_ + 1) * 0.5 * kPixels;
    const double y = (1 - dir.dot(up_) / depth / half_width_) * 0.5 * kPixels;
    if (!(x >= 0 && y >= 0 && x < kPixels && y < kPixels)) return 0;
    return ink_(static_cast<int>(y), static_cast<int>(x)) / 255.0;
  }

 private:
  static constexpr int kPixels = 256;
  Vec3 front_, up_, right_;
  double half_width_;
  cv::Mat_<std::uint8_t> ink_;
};

std::vector<Label> labels() {
  constexpr double kLarge = 0.2, kSmall = 0.07;
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  std::vector<Label> all = {{"+X", x, y, kLarge},  {"-X", -x, y, kLarge}, {"+Y", y, -z, kLarge},
                            {"-Y", -y, z, kLarge}, {"+Z", z, y, kLarge},  {"-Z", -z, y, kLarge}};
  for (int azimuth = 0; azimuth < 360; azimuth += 30) {
    // Below the horizon's line, clear of the large ones.
    const double a = azimuth * kDegree, lower = -8 * kDegree;
    const Vec3 around(std::sin(a), 0, std::cos(a));
    const bool on_axis = azimuth % 90 == 0;
    const double drop = on_axis ? 2.2 * lower : lower;
    const Vec3 front = std::cos(drop) * around + std::sin(drop) * y;
    all.push_back({std::to_string(azimuth), front, std::cos(drop) * y - std::sin(drop) * around, kSmall});
  }
  return all;
}

/// How much of a line of this width (radians) covers a point at this distance from it.
double line(double distance, double width, double pixel) {
  return std::clamp((0.5 * width - distance) / pixel + 0.5, 0.0, 1.0);
}

/// The distance of an angle (degrees) from the next multiple of 15.
double from_fifteen(double degrees) {
  return std::abs(std::remainder(degrees, 15.0)) * kDegree;
}

}  // namespace

Image<float> test_chart(int width) {
  HDR_ASSERT(width >= 64);
  constexpr int kSamples = 3;  // an axis
  const Size size{width, width / 2};
  const double pixel = 2 * kPi / width, thin = std::max(pixel, 0.004);
  const std::vector<Label> all = labels();
  Image<float> chart(size, 3);
  for_rows(size.height, 4, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width; ++x) {
        double ink = 0;
        for (int s = 0; s < kSamples * kSamples; ++s) {
          const Vec3 dir = dir_from_latlong((x + (s % kSamples + 0.5) / kSamples) / size.width,
                                            (y + (s / kSamples + 0.5) / kSamples) / size.height);
          double most = 0;
          for (const Label& label : all) most = std::max(most, label.at(dir));
          ink += most / (kSamples * kSamples);
        }
        const Vec3 dir = dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height);
        const double level = std::asin(std::clamp(dir.y(), -1.0, 1.0)), across = std::sqrt(1 - dir.y() * dir.y());
        const double meridian = from_fifteen(std::atan2(dir.x(), dir.z()) / kDegree) * across;
        const double dark = across > 0.12 ? std::max(line(from_fifteen(level / kDegree), thin, pixel),
                                                     line(meridian, thin, pixel * across))
                                          : line(from_fifteen(level / kDegree), thin, pixel);
        const double white = std::max(ink, line(std::abs(level), 2 * thin, pixel));
        for (int c = 0; c < 3; ++c) {
          const double colour = (0.5 + 0.5 * dir[c]) * (1 - 0.6 * dark);
          chart(x, y, c) = static_cast<float>(colour + white * (1 - colour));
        }
      }
    }
  });
  return chart;
}

}  // namespace hdr
