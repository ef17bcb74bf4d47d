#pragma once
// Luminance weights and transfer functions. Linear values are Rec. 709 primaries unless a map says otherwise.
#include <algorithm>
#include <cmath>

namespace hdr {

/// Relative luminance of linear Rec. 709 (ITU-R BT.709).
template <class T>
constexpr T luminance(T r, T g, T b) {
  return T(0.2126) * r + T(0.7152) * g + T(0.0722) * b;
}

/// IEC 61966-2-1: linear [0,1] -> sRGB [0,1]; values outside are clamped.
inline double srgb_from_linear(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

inline double linear_from_srgb(double y) {
  y = std::clamp(y, 0.0, 1.0);
  return y <= 0.04045 ? y / 12.92 : std::pow((y + 0.055) / 1.055, 2.4);
}

}  // namespace hdr
