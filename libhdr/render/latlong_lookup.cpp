#include "libhdr/render/internal/latlong_lookup.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hdr {
namespace {

// Angle of the point (x, y) from the x axis, -pi..pi. [Abramowitz64] 4.4.49: arctan on [0, 1] within 2e-8. Written
// without a branch, so that a loop of it becomes vector code.
inline float angle_of(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float larger = std::max(ax, ay), smaller = std::min(ax, ay);
  const float a = smaller / std::max(larger, 1e-30f), s = a * a;
  float p = 0.0028662257f;
  p = p * s - 0.0161657367f;
  p = p * s + 0.0429096138f;
  p = p * s - 0.0752896400f;
  p = p * s + 0.1065626393f;
  p = p * s - 0.1420889944f;
  p = p * s + 0.1999355085f;
  p = p * s - 0.3333314528f;
  p = a + a * s * p;
  constexpr float kHalf = std::numbers::pi_v<float> / 2;
  p = ay > ax ? kHalf - p : p;
  p = x < 0 ? 2 * kHalf - p : p;
  return std::copysign(p, y);
}

}  // namespace

void latlong_offsets(const float* dir_x, const float* dir_y, const float* dir_z, int count, View<const float> map,
                     std::int32_t* offsets) {
  const Size size = map.size();
  const auto stride = static_cast<std::int32_t>(map.stride()), channels = map.channels();
  const float columns = static_cast<float>(size.width) / (2 * std::numbers::pi_v<float>);
  const float rows = static_cast<float>(size.height) / std::numbers::pi_v<float>;
  const int last_column = size.width - 1, last_row = size.height - 1;
  for (int k = 0; k < count; ++k) {
    const float horizontal = std::sqrt(dir_x[k] * dir_x[k] + dir_z[k] * dir_z[k]);
    // u = 1/2 - azimuth / (2 pi), v = polar / pi, both without the cancellation of an arc cosine.
    const float u = 0.5f * static_cast<float>(size.width) - columns * angle_of(dir_x[k], dir_z[k]);
    const float v = rows * angle_of(horizontal, dir_y[k]);
    const int x = std::clamp(static_cast<int>(u), 0, last_column);
    const int y = std::clamp(static_cast<int>(v), 0, last_row);
    offsets[k] = y * stride + channels * x;
  }
}

Rgbf smooth_pixel(View<const float> map, const Vec3f& dir) {
  const int width = map.width(), height = map.height();
  const float horizontal = std::sqrt(dir.x() * dir.x() + dir.z() * dir.z());
  const float per_turn = static_cast<float>(width) / (2 * std::numbers::pi_v<float>);
  const float per_half_turn = static_cast<float>(height) / std::numbers::pi_v<float>;
  const float x = 0.5f * static_cast<float>(width) - per_turn * angle_of(dir.x(), dir.z()) - 0.5f;
  const float y = per_half_turn * angle_of(horizontal, dir.y()) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const float right_share = x - left, lower_share = y - top;
  // The seam is no edge, and over a pole the map goes on half a turn away.
  const auto row_of = [&](int j) {
    const bool over = j < 0 || j >= height;
    const float* row = map.row(std::clamp(j, 0, height - 1));
    const int first = static_cast<int>(left) + width + (over ? width / 2 : 0);
    const Eigen::Map<const Rgbf> a(row + 3 * (first % width)), b(row + 3 * ((first + 1) % width));
    return Rgbf(a * (1 - right_share) + b * right_share);
  };
  return row_of(static_cast<int>(top)) * (1 - lower_share) + row_of(static_cast<int>(top) + 1) * lower_share;
}

}  // namespace hdr
