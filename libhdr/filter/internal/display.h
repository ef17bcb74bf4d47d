#pragma once
// The last step of every tone mapping: display-linear light to sRGB codes.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "libhdr/core/color.h"
#include "libhdr/core/image.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {

inline double pixel_luminance(const float* p) {
  return luminance<double>(p[0], p[1], p[2]);
}

inline std::uint8_t code_from_linear(double x) {
  return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(x)));
}

/// display(x, y, rgb, out) gives three linear values, 1 being white; `alpha` (may be empty) becomes the fourth channel.
template <class Display>
Image<std::uint8_t> displayed(View<const float> rgb, View<const float> alpha, const Display& display) {
  HDR_ASSERT(rgb.channels() == 3);
  HDR_ASSERT(alpha.empty() || alpha.size() == rgb.size());
  const int channels = alpha.empty() ? 3 : 4;
  Image<std::uint8_t> codes(rgb.size(), channels);
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < rgb.width(); ++x) {
        double out[3];
        display(x, y, rgb.pixel(x, y), out);
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
