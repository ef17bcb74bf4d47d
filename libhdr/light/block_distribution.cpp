#include "libhdr/light/block_distribution.h"

#include <algorithm>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"

namespace hdr {
namespace {

constexpr double kBelowOne = 1 - 0x1p-53;

inline double weight_of(const float* p, double floor) {
  return std::max(0.0, luminance<double>(p[0], p[1], p[2]) - floor);
}

// Sum of some pixels, per channel. Twelve sums side by side, which a compiler makes vectors of.
Rgb sum_of(const float* p, int pixels) {
  constexpr int kLanes = 12;
  double lanes[kLanes] = {};
  int k = 0;
  for (; k + kLanes <= 3 * pixels; k += kLanes)
    for (int i = 0; i < kLanes; ++i) lanes[i] += p[k + i];
  for (int i = 0; k + i < 3 * pixels; ++i) lanes[i] += p[k + i];
  return {lanes[0] + lanes[3] + (lanes[6] + lanes[9]), lanes[1] + lanes[4] + (lanes[7] + lanes[10]),
          lanes[2] + lanes[5] + (lanes[8] + lanes[11])};
}

}  // namespace

BlockDistribution::BlockDistribution(View<const float> rgb, double floor)
    : rgb_(rgb),
      floor_(floor),
      blocks_((rgb.width() + kBlock - 1) / kBlock),
      row_sums_(static_cast<std::size_t>(rgb.height()), Rgb::Zero()),
      ends_(static_cast<std::size_t>(blocks_) * static_cast<std::size_t>(rgb.height())) {
  HDR_ASSERT(rgb.channels() == 3 && !rgb.empty() && floor >= 0);
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      double sum = 0;
      double* end = ends_.data() + static_cast<std::ptrdiff_t>(y) * blocks_;
      for (int x = 0; x < rgb.width(); x += kBlock) {
        // Of a block for itself first: small weights are not lost beside what came before.
        const int stop = std::min(x + kBlock, rgb.width());
        const Rgb pixels = sum_of(rgb.pixel(x, y), stop - x);
        row_sums_[static_cast<std::size_t>(y)] += pixels;
        double block = luminance(pixels[0], pixels[1], pixels[2]);
        if (floor > 0) {
          block = 0;
          for (int i = x; i < stop; ++i) block += weight_of(rgb.pixel(i, y), floor);
        }
        *end++ = sum += block;
      }
    }
  });
}

double BlockDistribution::weight(int x, int y) const {
  return weight_of(rgb_.pixel(x, y), floor_);
}

BlockDistribution::Place BlockDistribution::place_of(int y, double u) const {
  const double total = row_total(y);
  if (!(total > 0)) {
    const double column = u * rgb_.width();
    const int x = std::min(static_cast<int>(column), rgb_.width() - 1);
    return {x, std::clamp(column - x, 0.0, kBelowOne)};
  }
  const double* ends = ends_.data() + static_cast<std::ptrdiff_t>(y) * blocks_;
  // The first block whose end lies above: blocks of no weight are passed over. Rounding may leave none: the last that
  // has weight, which begins where its end is first reached.
  const double wanted = u * total;
  const double* found = std::upper_bound(ends, ends + blocks_, wanted);
  if (found == ends + blocks_) found = std::lower_bound(ends, ends + blocks_, total);
  const auto block = static_cast<int>(found - ends);
  const double inside_block = wanted - block_begin(y, block);
  const int x0 = block * kBlock, x1 = std::min(x0 + kBlock, rgb_.width());
  double sum = 0;
  Place last;
  for (int x = x0; x < x1; ++x) {
    const double w = weight_of(rgb_.pixel(x, y), floor_);
    if (w > 0) {
      last = {x, kBelowOne};
      if (sum + w > inside_block) return {x, std::clamp((inside_block - sum) / w, 0.0, kBelowOne)};
    }
    sum += w;
  }
  return last;
}

double BlockDistribution::invert(int y, const Place& place) const {
  const double total = row_total(y);
  if (!(total > 0)) return std::min((place.x + place.inside) / rgb_.width(), kBelowOne);
  const int block = place.x / kBlock;
  double sum = 0;
  for (int x = block * kBlock; x < place.x; ++x) sum += weight_of(rgb_.pixel(x, y), floor_);
  sum += place.inside * weight_of(rgb_.pixel(place.x, y), floor_);
  return std::min((block_begin(y, block) + sum) / total, kBelowOne);
}

}  // namespace hdr
