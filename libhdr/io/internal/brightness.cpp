#include "libhdr/io/internal/brightness.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hdr::internal {
namespace {

constexpr int kLevels = 4096;

/// Luma (Rec. 709 weights on codes), spread over kLevels.
std::vector<std::int64_t> luma_histogram(const Codes& lattice, int max_code) {
  std::vector<std::int64_t> histogram(kLevels);
  const float scale = (kLevels - 1.0f) / static_cast<float>(max_code);
  const float red = 0.2126f * scale, green = 0.7152f * scale, blue = 0.0722f * scale;
  const auto add = [&](const auto& codes) {
    for (int y = 0; y < codes.height(); ++y) {
      const auto* p = codes.row(y);
      for (int x = 0; x < codes.width(); ++x, p += 3) {
        const auto code = [&](int channel) { return static_cast<float>(p[channel]); };
        ++histogram[static_cast<std::size_t>(red * code(0) + green * code(1) + blue * code(2) + 0.5f)];
      }
    }
  };
  std::visit(add, lattice);
  return histogram;
}

}  // namespace

Brightness brightness_of(const PhotoSamples& samples, int max_code) {
  const std::vector<std::int64_t> histogram = luma_histogram(samples.lattice, max_code);
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
