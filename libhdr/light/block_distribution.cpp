#include "libhdr/light/block_distribution.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

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
      row_totals_(row_sums_.size()),
      ends_(static_cast<std::size_t>(blocks_) * static_cast<std::size_t>(rgb.height())) {
  HDR_ASSERT(rgb.channels() == 3 && !rgb.empty() && floor >= 0);
  cells_ = static_cast<int>(std::bit_ceil(static_cast<unsigned>(blocks_)));
  guide_.resize(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(rgb.height()));
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
      row_totals_[static_cast<std::size_t>(y)] = sum;
      make_guide(y);
    }
  });
}

double BlockDistribution::weight(int x, int y) const {
  return weight_of(rgb_.pixel(x, y), floor_);
}

// Entry k must not lie behind the block of k / cells_, and may lie before it: the ends are pushed up by more than
// rounding can amount to.
void BlockDistribution::make_guide(int y) {
  const double total = row_total(y);
  std::uint16_t* guide = guide_.data() + static_cast<std::ptrdiff_t>(y) * cells_;
  if (!(total > 0)) return;
  const double* ends = ends_.data() + static_cast<std::ptrdiff_t>(y) * blocks_;
  const double cells_per_weight = cells_ / total * (1 + 1e-12);
  constexpr int kLargest = std::numeric_limits<std::uint16_t>::max();
  for (int block = 1; block < blocks_; ++block) {
    const int first = static_cast<int>(ends[block - 1] * cells_per_weight) + 1;  // the first cell past the block before
    if (first < cells_) guide[first] = static_cast<std::uint16_t>(std::min(block, kLargest));
  }
  for (int k = 1; k < cells_; ++k) guide[k] = std::max(guide[k], guide[k - 1]);
}

std::size_t BlockDistribution::guide_index(int y, double u) const {
  const auto cell = std::min(static_cast<int>(u * cells_), cells_ - 1);
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(cell);
}

// The first block whose end lies above `wanted`, u of the row's weight: blocks of no weight are passed over.
int BlockDistribution::block_of(int y, double u, double wanted) const {
  const double* ends = ends_.data() + static_cast<std::ptrdiff_t>(y) * blocks_;
  int block = guide_[guide_index(y, u)];
  // One step without a branch is as far as it is in rows whose blocks weigh about the same.
  block += static_cast<int>(ends[block] <= wanted);
  if (ends[block] <= wanted) block = static_cast<int>(std::upper_bound(ends + block, ends + blocks_, wanted) - ends);
  return block;
}

BlockDistribution::Draw BlockDistribution::draw(int y, double u) const {
  const double total = row_total(y);
  if (!(total > 0)) return {y, -1, u * rgb_.width()};
  // Below the total, whatever was rounded: some block ends above it, and one that has weight.
  double wanted = u * total;
  if (wanted >= total) wanted = std::nextafter(total, 0.0);
  const int block = block_of(y, u, wanted);
  return {y, block, wanted - block_begin(y, block)};
}

void BlockDistribution::prefetch_draw(int y, double u) const {
  const int block = guide_[guide_index(y, u)];
  __builtin_prefetch(&ends_[static_cast<std::size_t>(y * blocks_ + block)]);
}

void BlockDistribution::prefetch_pixels(const Draw& draw) const {
  const int x0 = std::max(draw.block, 0) * kBlock, last = std::min(x0 + kBlock, rgb_.width()) - 1;
  const auto* end = reinterpret_cast<const char*>(rgb_.pixel(last, draw.y));
  constexpr int kLine = 64;
  for (const auto* p = reinterpret_cast<const char*>(rgb_.pixel(x0, draw.y)); p < end; p += kLine)
    __builtin_prefetch(p);
  __builtin_prefetch(end);
}

BlockDistribution::Place BlockDistribution::place_of(int y, double u) const {
  return place_in(draw(y, u));
}

BlockDistribution::Place BlockDistribution::place_in(const Draw& draw) const {
  if (draw.block < 0) {
    const int x = std::min(static_cast<int>(draw.inside), rgb_.width() - 1);
    return {x, std::clamp(draw.inside - x, 0.0, kBelowOne)};
  }
  const double inside_block = draw.inside;
  const int x0 = draw.block * kBlock, pixels = std::min(kBlock, rgb_.width() - x0);
  // The pixel is the first whose running sum lies above: pixels of no weight are passed over. Counting has no branch to
  // guess wrong, so a processor goes on to the next draw while it waits for this one's pixels.
  double weights[kBlock] = {}, ends[kBlock];
  const float* p = rgb_.pixel(x0, draw.y);
  if (pixels == kBlock) {
    for (int i = 0; i < kBlock; ++i) weights[i] = weight_of(p + 3 * i, floor_);
  } else {
    for (int i = 0; i < pixels; ++i) weights[i] = weight_of(p + 3 * i, floor_);
  }
  double sum = 0;
  int before = 0;
  for (int i = 0; i < kBlock; ++i) {
    ends[i] = sum += weights[i];
    before += static_cast<int>(sum <= inside_block);
  }
  if (before == kBlock) {  // rounding: the last that has weight
    before = pixels - 1;
    while (before > 0 && !(weights[before] > 0)) --before;
    return {x0 + before, kBelowOne};
  }
  const double begin = before == 0 ? 0 : ends[before - 1];
  return {x0 + before, std::clamp((inside_block - begin) / weights[before], 0.0, kBelowOne)};
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
