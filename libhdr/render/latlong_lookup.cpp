// Angles by loops without a branch, which the compiler makes vectors of, for each kind of vector that Highway knows of.
#include "libhdr/render/internal/latlong_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/render/latlong_lookup.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {

// Angle of the point (x, y) from the x axis, -pi..pi. [Abramowitz64] 4.4.49: arctan on [0, 1] within 2e-8.
HWY_INLINE float angle_of(float y, float x) {
  const float ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const float larger = ax > ay ? ax : ay, smaller = ax > ay ? ay : ax;
  const float a = smaller / (larger > 1e-30f ? larger : 1e-30f), s = a * a;
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
  return __builtin_copysignf(p, y);
}

// Columns and rows, from the map's corner, of u = 1/2 - azimuth / (2 pi), v = polar / pi, both without the cancellation
// of an arc cosine.
void LatlongPlaces(const float* dir_x, const float* dir_y, const float* dir_z, int count, const Size& size,
                   float* HWY_RESTRICT x, float* HWY_RESTRICT y) {
  const float width = static_cast<float>(size.width);
  const float per_radian = width / (2 * std::numbers::pi_v<float>);
  const float rows_per_radian = static_cast<float>(size.height) / std::numbers::pi_v<float>;
  for (int k = 0; k < count; ++k) {
    const float horizontal = __builtin_sqrtf(dir_x[k] * dir_x[k] + dir_z[k] * dir_z[k]);
    x[k] = 0.5f * width - per_radian * angle_of(dir_x[k], dir_z[k]);
    y[k] = rows_per_radian * angle_of(horizontal, dir_y[k]);
  }
}

void LatlongOffsets(const float* dir_x, const float* dir_y, const float* dir_z, int count, View<const float> map,
                    std::int32_t* HWY_RESTRICT offsets) {
  constexpr int kAtOnce = 64;
  float x[kAtOnce], y[kAtOnce];
  const auto stride = static_cast<std::int32_t>(map.stride()), channels = map.channels();
  const int last_column = map.width() - 1, last_row = map.height() - 1;
  for (int first = 0; first < count; first += kAtOnce) {
    const int here = count - first < kAtOnce ? count - first : kAtOnce;
    LatlongPlaces(dir_x + first, dir_y + first, dir_z + first, here, map.size(), x, y);
    std::int32_t* HWY_RESTRICT out = offsets + first;
    for (int k = 0; k < here; ++k) {
      int column = static_cast<int>(x[k]), row = static_cast<int>(y[k]);
      column = column < 0 ? 0 : column > last_column ? last_column : column;
      row = row < 0 ? 0 : row > last_row ? last_row : row;
      out[k] = row * stride + channels * column;
    }
  }
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr {
namespace internal {
HWY_EXPORT(LatlongPlaces);
HWY_EXPORT(LatlongOffsets);
}  // namespace internal

namespace {

// At x columns and y rows from the map's corner.
Rgbf smooth_at(View<const float> map, float x, float y) {
  const int width = map.width(), height = map.height();
  const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
  const float right_share = x - 0.5f - left, lower_share = y - 0.5f - top;
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

}  // namespace

void latlong_offsets(const float* dir_x, const float* dir_y, const float* dir_z, int count, View<const float> map,
                     std::int32_t* offsets) {
  HWY_DYNAMIC_DISPATCH(internal::LatlongOffsets)(dir_x, dir_y, dir_z, count, map, offsets);
}

void smooth_pixels(View<const float> map, std::span<const Vec3f> dirs, std::span<Rgbf> pixels) {
  constexpr std::size_t kAtOnce = 64;
  std::array<float, kAtOnce> dir_x, dir_y, dir_z, x, y;
  for (std::size_t first = 0; first < dirs.size(); first += kAtOnce) {
    const std::size_t here = std::min(dirs.size() - first, kAtOnce);
    for (std::size_t k = 0; k < here; ++k) {
      const Vec3f& dir = dirs[first + k];
      dir_x[k] = dir.x(), dir_y[k] = dir.y(), dir_z[k] = dir.z();
    }
    HWY_DYNAMIC_DISPATCH(internal::LatlongPlaces)
    (dir_x.data(), dir_y.data(), dir_z.data(), static_cast<int>(here), map.size(), x.data(), y.data());
    for (std::size_t k = 0; k < here; ++k) pixels[first + k] = smooth_at(map, x[k], y[k]);
  }
}

Rgbf smooth_pixel(View<const float> map, const Vec3f& dir) {
  Rgbf pixel;
  smooth_pixels(map, {&dir, 1}, {&pixel, 1});
  return pixel;
}

}  // namespace hdr
#endif
