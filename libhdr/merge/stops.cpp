#include "libhdr/merge/internal/stops.h"

#include <bit>
#include <cmath>
#include <numeric>

#include "libhdr/core/color.h"

namespace hdr::internal {
namespace {

// The leading bits of a positive float rise with it: exponent and 7 bits of mantissa make bins of at most 1/90 stop.
constexpr int kShift = 16;
constexpr std::size_t kBins = 0x7f800000u >> kShift;

/// The geometric middle of the bin that holds rank `share` of the count.
double log2_quantile(const std::vector<std::int64_t>& bins, std::int64_t count, double share) {
  const double rank = share * static_cast<double>(count);
  std::int64_t below = 0;
  std::uint32_t bin = 0;
  while (bin + 1 < kBins && static_cast<double>(below + bins[bin]) <= rank) below += bins[bin++];
  return std::log2(std::bit_cast<float>((bin << kShift) + (1u << (kShift - 1))));
}

}  // namespace

LuminanceHistogram::LuminanceHistogram() : bins_(kBins) {}

void LuminanceHistogram::add(View<const float> rgb) {
  for (int y = 0; y < rgb.height(); ++y) {
    const float* p = rgb.row(y);
    for (int x = 0; x < rgb.width(); ++x, p += 3) {
      const float value = luminance(p[0], p[1], p[2]);
      if (value > 0) ++bins_[std::bit_cast<std::uint32_t>(value) >> kShift];
    }
  }
}

void LuminanceHistogram::join(const LuminanceHistogram& part) {
  for (std::size_t k = 0; k < kBins; ++k) bins_[k] += part.bins_[k];
}

double LuminanceHistogram::stops() const {
  const std::int64_t count = std::accumulate(bins_.begin(), bins_.end(), std::int64_t{0});
  if (count == 0) return 0;
  return log2_quantile(bins_, count, 0.999) - log2_quantile(bins_, count, 0.001);
}

}  // namespace hdr::internal
