#pragma once
// The last step of every tone mapping: display-linear light to sRGB codes.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "libhdr/core/color.h"
#include "libhdr/core/image.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {

/// What is no number is no light to measure by.
inline double pixel_luminance(const float* p) {
  const double value = luminance<double>(p[0], p[1], p[2]);
  return std::isfinite(value) ? value : 0;
}

/// Of stops beyond 200 the picture is black or white anyhow, and their squares are still numbers.
inline double gain_from_stops(double stops) {
  return std::exp2(std::clamp(stops, -200.0, 200.0));
}

inline std::uint8_t code_from_linear(double x) {
  return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(x)));
}

/// display(x, y, rgb, out) gives three linear values, 1 being white; `alpha` (may be empty) becomes the fourth channel.
/// It sees finite numbers: NaN is black, infinity as bright as can be.
template <class Display>
Image<std::uint8_t> displayed(View<const float> rgb, View<const float> alpha, const Display& display) {
  HDR_ASSERT(rgb.channels() == 3);
  HDR_ASSERT(alpha.empty() || alpha.size() == rgb.size());
  constexpr float kMost = std::numeric_limits<float>::max();
  const int channels = alpha.empty() ? 3 : 4;
  Image<std::uint8_t> codes(rgb.size(), channels);
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < rgb.width(); ++x) {
        float seen[3];
        for (int c = 0; c < 3; ++c) {
          const float value = rgb(x, y, c);
          seen[c] = std::isnan(value) ? 0 : std::clamp(value, -kMost, kMost);
        }
        double out[3];
        display(x, y, seen, out);
        for (int c = 0; c < 3; ++c) codes(x, y, c) = code_from_linear(out[c]);
        if (channels == 4) {
          codes(x, y, 3) = static_cast<std::uint8_t>(std::lround(255 * std::clamp(alpha(x, y), 0.0f, 1.0f)));
        }
      }
    }
  });
  return codes;
}

}  // namespace hdr::internal
