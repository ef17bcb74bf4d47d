// What the vectors of pixel_block_simd.cpp mean.
#include "libhdr/light/internal/pixel_block.h"

namespace hdr::reference {

Rgb sum_blocks(const float* row, int width, double floor, double* blocks) {
  Rgb total = Rgb::Zero();
  for (int first = 0; first < width; first += kPixelBlock) {
    double block = 0;
    for (int x = first; x < std::min(first + kPixelBlock, width); ++x) {
      const float* p = row + 3 * x;
      total += Rgb(p[0], p[1], p[2]);
      block += pixel_weight(p, floor);
    }
    *blocks++ = block;
  }
  return total;
}

PixelPlace place_in_block(const float* block, int pixels, double floor, double wanted) {
  double sum = 0;
  int last = 0;  // that has weight: where rounding leads past the end
  for (int k = 0; k < pixels; ++k) {
    const double weight = pixel_weight(block + 3 * k, floor);
    if (sum + weight > wanted) return {k, std::clamp((wanted - sum) / weight, 0.0, kBelowOne), weight};
    sum += weight;
    if (weight > 0) last = k;
  }
  return {last, kBelowOne, pixel_weight(block + 3 * last, floor)};
}

}  // namespace hdr::reference
