#include "libhdr/filter/tonemap.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"

namespace hdr {
namespace {

double pixel_luminance(const float* p) {
  return luminance<double>(p[0], p[1], p[2]);
}

/// The luminance that 99.9 % of the pixels do not exceed.
double white_of(View<const float> rgb) {
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(rgb.width()) * static_cast<std::size_t>(rgb.height()));
  for (int y = 0; y < rgb.height(); ++y)
    for (int x = 0; x < rgb.width(); ++x) values.push_back(static_cast<float>(pixel_luminance(rgb.pixel(x, y))));
  if (values.empty()) return 0;
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), rank, values.end());
  return *rank;
}

std::uint8_t code_from_linear(double x) {
  return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(x)));
}

}  // namespace

double metered_stops(View<const float> rgb) {
  double sum = 0;
  std::int64_t count = 0;
  for (int y = 0; y < rgb.height(); ++y) {
    for (int x = 0; x < rgb.width(); ++x) {
      const double value = pixel_luminance(rgb.pixel(x, y));
      if (!(value > 0)) continue;
      sum += std::log2(value);
      ++count;
    }
  }
  if (count == 0) return 0;
  return std::log2(0.18) - sum / static_cast<double>(count);
}

Image<std::uint8_t> tonemap(View<const float> rgb, double stops, View<const float> alpha) {
  HDR_ASSERT(rgb.channels() == 3);
  HDR_ASSERT(alpha.empty() || alpha.size() == rgb.size());
  const double gain = std::exp2(stops);
  // A white below 1 would brighten the picture instead of making room for highlights.
  const double white = std::max(1.0, gain * white_of(rgb));
  const int channels = alpha.empty() ? 3 : 4;
  Image<std::uint8_t> codes(rgb.size(), channels);
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < rgb.width(); ++x) {
        const float* p = rgb.pixel(x, y);
        // [Reinhard02] eq. 4: L_d = L (1 + L / L_white^2) / (1 + L); the colour keeps its ratios.
        const double value = gain * pixel_luminance(p);
        const double shoulder = gain * (1 + value / (white * white)) / (1 + value);
        for (int c = 0; c < 3; ++c) codes(x, y, c) = code_from_linear(shoulder * p[c]);
        if (channels == 4) {
          codes(x, y, 3) = static_cast<std::uint8_t>(std::lround(255 * std::clamp(alpha(x, y), 0.0f, 1.0f)));
        }
      }
    }
  });
  return codes;
}

}  // namespace hdr
