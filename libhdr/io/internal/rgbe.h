#pragma once
// A pixel of Radiance's files [Ward91]: three 8-bit mantissas m under one exponent e, excess 128.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "libhdr/io/read.h"

namespace hdr::internal {

using Rgbe = std::array<std::uint8_t, 4>;

/// Below this the pixel is zero (Radiance's color.c).
inline constexpr double kRgbeBlack = 1e-32;
/// The largest value that fits: mantissa 255, exponent byte 255.
inline constexpr double kRgbeLargest = 0x1.fep126;

/// 2^(e-136) for each exponent byte; 0 for e = 0, which is black: value = m 2^(e-136), as the mantissa is m/256 (and
/// not m, as the lecture has it). Powers of two, so that a product with a mantissa is exact in float.
inline const std::array<float, 256>& rgbe_scales() {
  static const std::array<float, 256> scales = [] {
    std::array<float, 256> all{};
    for (int e = 1; e < 256; ++e) all[static_cast<std::size_t>(e)] = std::ldexp(1.0f, e - 136);
    return all;
  }();
  return scales;
}
inline double rgbe_scale(std::uint8_t exponent) {
  return rgbe_scales()[exponent];
}

/// The nearest mantissas under the exponent of the largest component; negative ones count as 0. Expects components up
/// to kRgbeLargest.
inline Rgbe rgbe_from_rgb(const float* rgb) {
  const float largest = std::max({rgb[0], rgb[1], rgb[2]});
  if (!(largest >= static_cast<float>(kRgbeBlack))) return {};
  // largest = f 2^exponent with f in [1/2, 1): its own exponent bits, since 1e-32 is no subnormal.
  const auto bits = std::bit_cast<std::uint32_t>(largest);
  int exponent = static_cast<int>(bits >> 23) - 126;
  constexpr std::uint32_t kFraction = 0x7fffff, kRoundsUp = 0x7f8000;  // 255.5/256 = 0x1.ff p-1: would become 256
  if ((bits & kFraction) >= kRoundsUp) ++exponent;
  // The quantum's inverse 2^(8-exponent) by its bits: exponent is -106 to 127.
  const auto per_value = std::bit_cast<float>(static_cast<std::uint32_t>(8 - exponent + 127) << 23);
  const auto mantissa = [&](float v) { return static_cast<std::uint8_t>(std::max(0.0f, v) * per_value + 0.5f); };
  return {mantissa(rgb[0]), mantissa(rgb[1]), mantissa(rgb[2]), static_cast<std::uint8_t>(exponent + 128)};
}

}  // namespace hdr::internal
