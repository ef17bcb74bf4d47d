#include "libhdr/probe/internal/luminance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {

namespace {

/// NaN becomes 0.
float within_bounds(float value) {
  constexpr float kMost = 1e30f;
  return std::min(std::max(0.0f, value), kMost);
}

}  // namespace

Image<float> luminance_of(View<const float> picture) {
  Image<float> result(picture.size(), 1);
  for_rows(picture.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const float* p = picture.pixel(x, y);
        const float value = picture.channels() < 3 ? p[0] : static_cast<float>(luminance(p[0], p[1], p[2]));
        result(x, y) = within_bounds(value);
      }
    }
  });
  return result;
}

Image<float> channel_of(View<const float> picture, int channel) {
  Image<float> result(picture.size(), 1);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) result(x, y) = within_bounds(picture(x, y, channel));
  }
  return result;
}

Image<float> halved(View<const float> picture) {
  Image<float> half(picture.width() / 2, picture.height() / 2, 1);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      half(x, y) = 0.25f * (picture(2 * x, 2 * y) + picture(2 * x + 1, 2 * y) + picture(2 * x, 2 * y + 1) +
                            picture(2 * x + 1, 2 * y + 1));
    }
  }
  return half;
}

std::vector<Image<float>> halvings(Image<float> picture, int longest, int shortest) {
  std::vector<Image<float>> levels;
  levels.push_back(std::move(picture));
  const auto may_halve = [&](Size size) {
    return std::max(size.width, size.height) > longest && std::min(size.width, size.height) >= 2 * shortest;
  };
  while (may_halve(levels.back().size())) levels.push_back(halved(levels.back()));
  return levels;
}

double bilinear(View<const float> picture, const Vec2& px) {
  const double x = std::clamp(px.x() - 0.5, 0.0, picture.width() - 1.001);
  const double y = std::clamp(px.y() - 0.5, 0.0, picture.height() - 1.001);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const double fx = x - left, fy = y - top;
  return (1 - fy) * ((1 - fx) * picture(left, top) + fx * picture(left + 1, top)) +
         fy * ((1 - fx) * picture(left, top + 1) + fx * picture(left + 1, top + 1));
}

}  // namespace hdr::internal
