#include "libhdr/merge/internal/stops.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"

namespace hdr {
namespace {

// The leading bits of a positive float rise with it: exponent and 7 bits of mantissa make bins of at most 1/90 stop.
constexpr int kShift = 16;
constexpr std::size_t kBins = 0x7f800000u >> kShift;
using Histogram = std::vector<std::int64_t>;

Histogram luminance_histogram(View<const float> rgb) {
  return reduce_rows(
      rgb.height(), 512, Histogram(kBins),
      [&](int first, int last) {
        Histogram part(kBins);
        for (int y = first; y < last; ++y) {
          const float* p = rgb.row(y);
          for (int x = 0; x < rgb.width(); ++x, p += 3) {
            const float value = luminance(p[0], p[1], p[2]);
            if (value > 0) ++part[std::bit_cast<std::uint32_t>(value) >> kShift];
          }
        }
        return part;
      },
      [](Histogram& total, const Histogram& part) {
        for (std::size_t k = 0; k < kBins; ++k) total[k] += part[k];
      });
}

/// The geometric middle of the bin that holds rank `share` of the count.
double log2_quantile(const Histogram& histogram, std::int64_t count, double share) {
  const double rank = share * static_cast<double>(count);
  std::int64_t below = 0;
  std::uint32_t bin = 0;
  while (bin + 1 < kBins && static_cast<double>(below + histogram[bin]) <= rank) below += histogram[bin++];
  return std::log2(std::bit_cast<float>((bin << kShift) + (1u << (kShift - 1))));
}

}  // namespace

double stops_of_luminance(View<const float> rgb) {
  const Histogram histogram = luminance_histogram(rgb);
  const std::int64_t count = std::accumulate(histogram.begin(), histogram.end(), std::int64_t{0});
  if (count == 0) return 0;
  return log2_quantile(histogram, count, 0.999) - log2_quantile(histogram, count, 0.001);
}

}  // namespace hdr
