#include "libhdr/io/internal/brightness.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hdr::internal {
namespace {

constexpr int kLevels = 4096;
constexpr int kSamplesWanted = 1 << 18;  ///< pixels on a regular grid: a quantile is then known to about 0.1 %

/// Luma (Rec. 709 weights on codes), spread over kLevels.
std::vector<std::int64_t> luma_histogram(PhotoRows& rows, int max_code) {
  std::vector<std::int64_t> histogram(kLevels);
  const Size size = rows.size();
  const double pixels = 1.0 * size.width * size.height;
  const int step = std::max(1, static_cast<int>(std::sqrt(pixels / kSamplesWanted)));
  const double scale = (kLevels - 1.0) / max_code;
  const auto add_row = [&](const auto& row) {
    for (int x = step / 2; x < size.width; x += step) {
      const auto* p = row.pixel(x, 0);
      const double luma = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
      ++histogram[static_cast<std::size_t>(std::lround(scale * luma))];
    }
  };
  for (int y = step / 2; y < size.height; y += step) std::visit(add_row, rows.rows(y, y + 1));
  rows.rows(size.height, size.height);  // what is damaged below the last sample is found out too
  return histogram;
}

}  // namespace

Brightness brightness_of(PhotoRows& rows, int max_code) {
  const std::vector<std::int64_t> histogram = luma_histogram(rows, max_code);
  std::int64_t total = 0;
  double sum = 0;
  for (std::size_t level = 0; level < histogram.size(); ++level) {
    total += histogram[level];
    sum += static_cast<double>(level) * static_cast<double>(histogram[level]);
  }
  constexpr double kCodesPerLevel = 255.0 / (kLevels - 1);
  Brightness brightness;
  brightness.mean = total > 0 ? kCodesPerLevel * sum / static_cast<double>(total) : 0;
  std::size_t level = 0;
  std::int64_t below = histogram[0];  // pixels at `level` or darker
  for (int q = 0; q < Brightness::kQuantiles; ++q) {
    const double wanted = (q + 1.0) / (Brightness::kQuantiles + 1.0) * static_cast<double>(total);
    while (static_cast<double>(below) < wanted && level + 1 < histogram.size()) below += histogram[++level];
    brightness.quantiles[static_cast<std::size_t>(q)] = kCodesPerLevel * static_cast<double>(level);
  }
  return brightness;
}

bool darker_throughout(const Brightness& longer, const Brightness& shorter) {
  constexpr double kNoise = 0.5, kClearly = 2;  // codes of 255
  constexpr int kGoodPart = 5;                  // of the 19 quantiles: a quarter of the picture, more than a passer-by
  int clearly_darker = 0;
  for (std::size_t q = 0; q < longer.quantiles.size(); ++q) {
    const double difference = longer.quantiles[q] - shorter.quantiles[q];
    if (difference > kNoise) return false;
    if (difference <= -kClearly) ++clearly_darker;
  }
  return clearly_darker >= kGoodPart;
}

}  // namespace hdr::internal
