#include "libhdr/light/block_distribution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libhdr/core/parallel.h"
#include "libhdr/light/internal/pixel_block.h"

namespace hdr {
namespace {

constexpr int kLargest = std::numeric_limits<std::uint16_t>::max();

}  // namespace

BlockDistribution::BlockDistribution(View<const float> rgb, double floor)
    : rgb_(rgb),
      floor_(floor),
      blocks_((rgb.width() + kBlock - 1) / kBlock),
      row_sums_(static_cast<std::size_t>(rgb.height()), Rgb::Zero()),
      row_totals_(row_sums_.size()),
      ends_(static_cast<std::size_t>(blocks_) * static_cast<std::size_t>(rgb.height())) {
  HDR_ASSERT(rgb.channels() == 3 && !rgb.empty() && floor >= 0);
  guide_.resize(static_cast<std::size_t>(kCells) * static_cast<std::size_t>(rgb.height()));
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const auto row = static_cast<std::size_t>(y);
      double* ends = ends_.data() + static_cast<std::ptrdiff_t>(y) * blocks_;
      row_sums_[row] = sum_blocks(rgb.row(y), rgb.width(), floor, ends);
      std::partial_sum(ends, ends + blocks_, ends);
      row_totals_[row] = ends[blocks_ - 1];
      make_guide(y);
    }
  });
}

double BlockDistribution::weight(int x, int y) const {
  return pixel_weight(rgb_.pixel(x, y), floor_);
}

// Entry k must not lie behind the block of k / kCells, and may lie before it: what is looked for is lowered by more
// than rounding can amount to.
void BlockDistribution::make_guide(int y) {
  const double total = row_total(y);
  std::uint16_t* guide = guide_.data() + static_cast<std::ptrdiff_t>(y) * kCells;
  if (!(total > 0)) return;
  const double* ends = ends_.data() + static_cast<std::ptrdiff_t>(y) * blocks_;
  int block = 0;
  for (int k = 1; k < kCells; ++k) {
    const double begin = total * k / kCells * (1 - 1e-12);
    block = static_cast<int>(std::upper_bound(ends + block, ends + blocks_, begin) - ends);
    guide[k] = static_cast<std::uint16_t>(std::min(block, kLargest));
  }
}

// The blocks that a share u lies in, but for rounding.
BlockDistribution::Range BlockDistribution::blocks_near(int y, double u) const {
  const auto cell = std::min(static_cast<int>(u * kCells), kCells - 1);
  const std::uint16_t* guide = guide_.data() + static_cast<std::ptrdiff_t>(y) * kCells + cell;
  return {guide[0], cell + 1 < kCells && guide[1] < kLargest ? guide[1] : blocks_ - 1};
}

// The first block whose end lies above `wanted`, u of the row's weight: blocks of no weight are passed over. Halving
// without a branch to guess wrong; in most rows what is read lies in one or two cache lines.
int BlockDistribution::block_of(int y, double u, double wanted) const {
  const double* ends = ends_.data() + static_cast<std::ptrdiff_t>(y) * blocks_;
  const Range range = blocks_near(y, u);
  const double* first = ends + range.first;
  for (int count = range.last - range.first; count > 0;) {
    const int half = (count + 1) / 2;
    first += first[half - 1] <= wanted ? half : 0;
    count -= half;
  }
  while (*first <= wanted) ++first;  // rounding, at the end of a cell of the guide
  return static_cast<int>(first - ends);
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
  const Range range = blocks_near(y, u);
  const double* ends = ends_.data() + static_cast<std::ptrdiff_t>(y) * blocks_;
  __builtin_prefetch(ends + range.first);
  __builtin_prefetch(ends + (range.first + range.last) / 2);
  __builtin_prefetch(ends + range.last);
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
    return {x, std::clamp(draw.inside - x, 0.0, kBelowOne), 0};
  }
  const int x0 = draw.block * kBlock, pixels = std::min(kBlock, rgb_.width() - x0);
  const PixelPlace place = place_in_block(rgb_.pixel(x0, draw.y), pixels, floor_, draw.inside);
  return {x0 + place.index, place.inside, place.weight};
}

double BlockDistribution::invert(int y, const Place& place) const {
  const double total = row_total(y);
  if (!(total > 0)) return std::min((place.x + place.inside) / rgb_.width(), kBelowOne);
  const int block = place.x / kBlock;
  double sum = 0;
  for (int x = block * kBlock; x < place.x; ++x) sum += pixel_weight(rgb_.pixel(x, y), floor_);
  sum += place.inside * pixel_weight(rgb_.pixel(place.x, y), floor_);
  return std::min((block_begin(y, block) + sum) / total, kBelowOne);
}

}  // namespace hdr
