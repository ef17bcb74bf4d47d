#include "libhdr/filter/tonemap.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/filter/internal/display.h"
#include "libhdr/filter/internal/local_tone.h"
#include "libhdr/filter/internal/quantile.h"

namespace hdr {
namespace {

using internal::displayed;
using internal::pixel_luminance;

/// Extended Reinhard.
Image<std::uint8_t> reinhard(View<const float> rgb, double stops, View<const float> alpha) {
  const double gain = internal::gain_from_stops(stops);
  // A white below 1 would brighten the picture instead of making room for highlights.
  const double white = std::max(1.0, gain * internal::luminance_quantile(rgb, 0.999));
  return displayed(rgb, alpha, [&](int, int, const float* p, double* out) {
    // [Reinhard02] eq. 4: L_d = L (1 + L / L_white^2) / (1 + L); the colour keeps its ratios.
    const double value = gain * pixel_luminance(p);
    const double shoulder = gain * (1 + value / (white * white)) / (1 + value);
    for (int c = 0; c < 3; ++c) out[c] = shoulder * p[c];
  });
}

/// [Hable10]: U2Func with its published constants, an exposure bias of 2, white at 11.2.
double hable(double x) {
  constexpr double kA = 0.15, kB = 0.50, kC = 0.10, kD = 0.20, kE = 0.02, kF = 0.30;
  return (x * (kA * x + kC * kB) + kD * kE) / (x * (kA * x + kB) + kD * kF) - kE / kF;
}

Image<std::uint8_t> filmic(View<const float> rgb, double stops, View<const float> alpha) {
  constexpr double kBias = 2, kWhite = 11.2;
  const double gain = kBias * internal::gain_from_stops(stops), per_white = 1 / hable(kWhite);
  return displayed(rgb, alpha, [&](int, int, const float* p, double* out) {
    for (int c = 0; c < 3; ++c) out[c] = hable(std::max(0.0, gain * p[c])) * per_white;
  });
}

Image<std::uint8_t> clip(View<const float> rgb, double stops, View<const float> alpha) {
  const double gain = internal::gain_from_stops(stops);
  return displayed(rgb, alpha, [&](int, int, const float* p, double* out) {
    for (int c = 0; c < 3; ++c) out[c] = gain * p[c];
  });
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

std::optional<ToneOperator> tone_operator_from_name(const std::string& name) {
  if (name == "reinhard") return ToneOperator::kReinhard;
  if (name == "filmic") return ToneOperator::kFilmic;
  if (name == "local" || name == "bilateral") return ToneOperator::kLocal;
  if (name == "clip") return ToneOperator::kClip;
  return std::nullopt;
}

Image<std::uint8_t> tonemap(View<const float> rgb, double stops, View<const float> alpha, ToneOperator tone) {
  switch (tone) {
    case ToneOperator::kFilmic:
      return filmic(rgb, stops, alpha);
    case ToneOperator::kLocal:
      return internal::local_tone(rgb, stops, alpha);
    case ToneOperator::kClip:
      return clip(rgb, stops, alpha);
    case ToneOperator::kReinhard:
      break;
  }
  return reinhard(rgb, stops, alpha);
}

}  // namespace hdr
