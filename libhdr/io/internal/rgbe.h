#pragma once
// A pixel of Radiance's files [Ward91]: three 8-bit mantissas m under one exponent e, excess 128.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libhdr/io/read.h"

namespace hdr::internal {

using Rgbe = std::array<std::uint8_t, 4>;

/// Below this the pixel is zero (Radiance's color.c).
inline constexpr double kRgbeBlack = 1e-32;
/// The largest value that fits: mantissa 255, exponent byte 255.
inline constexpr double kRgbeLargest = 0x1.fep126;

/// value = m 2^(e-136): the mantissa is m/256 (and not m, as the lecture has it); e = 0 is black.
inline double rgbe_scale(std::uint8_t exponent) {
  return exponent == 0 ? 0.0 : std::ldexp(1.0, exponent - 136);
}

/// The nearest mantissas under the exponent of the largest component; negative ones count as 0. Expects components up
/// to kRgbeLargest.
inline Rgbe rgbe_from_rgb(const float* rgb) {
  const double largest = std::max({rgb[0], rgb[1], rgb[2]});
  if (!(largest >= kRgbeBlack)) return {};
  int exponent = 0;
  if (std::frexp(largest, &exponent) >= 255.5 / 256) ++exponent;  // would round up to 256
  if (exponent < -127) return {};
  const double per_value = std::ldexp(1.0, 8 - exponent);
  const auto mantissa = [&](float v) { return static_cast<std::uint8_t>(std::lround(std::max(0.0, v * per_value))); };
  return {mantissa(rgb[0]), mantissa(rgb[1]), mantissa(rgb[2]), static_cast<std::uint8_t>(exponent + 128)};
}

}  // namespace hdr::internal
