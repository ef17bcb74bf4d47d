#include "libhdr/light/block_alias.h"

#include <algorithm>
#include <numeric>

#include "libhdr/core/parallel.h"
#include "libhdr/light/internal/pixel_block.h"

namespace hdr {

BlockAlias::BlockAlias(View<const float> rgb, double floor)
    : rgb_(rgb),
      floor_(floor),
      blocks_((rgb.width() + kPixelBlock - 1) / kPixelBlock),
      row_sums_(static_cast<std::size_t>(rgb.height()), Rgb::Zero()),
      row_totals_(row_sums_.size()),
      columns_(static_cast<std::size_t>(blocks_) * row_sums_.size()) {
  HDR_ASSERT(rgb.channels() == 3 && !rgb.empty() && floor >= 0);
  for_rows(rgb.height(), 16, [&](int first, int last) {
    std::vector<double> weights(static_cast<std::size_t>(blocks_));
    for (int y = first; y < last; ++y) {
      const auto row = static_cast<std::size_t>(y);
      row_sums_[row] = sum_blocks(rgb.row(y), rgb.width(), floor, weights.data());
      row_totals_[row] = std::accumulate(weights.begin(), weights.end(), 0.0);
      make_table(weights, row_totals_[row], columns_.data() + static_cast<std::ptrdiff_t>(y) * blocks_);
    }
  });
}

// Every column of the table is as wide as the mean weight. Blocks below the mean leave room in theirs, which the blocks
// above it fill, one after the other; one that has fallen below the mean by giving is filled up by the next. Weights
// come in their order, so that neither list of [Vose91] is kept.
void BlockAlias::make_table(const std::vector<double>& weights, double total, Column* table) const {
  if (!(total > 0)) return;
  const double per_mean = blocks_ / total;
  const auto weight_of = [&](int block) { return weights[static_cast<std::size_t>(block)] * per_mean; };
  const auto next_large = [&](int block) {
    while (block < blocks_ && weight_of(block) < 1) ++block;
    return block;
  };
  int giver = next_large(0);
  double left = giver < blocks_ ? weight_of(giver) : 0;
  for (int block = 0; block < blocks_; ++block) {
    const double own = weight_of(block);
    if (!(own < 1)) continue;
    // Rounding may leave no giver at the end: what would be given then is nothing.
    table[block] = {giver < blocks_ ? static_cast<float>(own) : 1.0f,
                    static_cast<std::uint32_t>(giver < blocks_ ? giver : block)};
    left -= 1 - own;
    while (left < 1 && giver < blocks_) {
      const int next = next_large(giver + 1);
      const bool none = next == blocks_;
      table[giver] = {none ? 1.0f : static_cast<float>(std::max(0.0, left)),
                      static_cast<std::uint32_t>(none ? giver : next)};
      left = none ? 0 : left + weight_of(next) - 1;
      giver = next;
    }
  }
  // Who has given nothing away keeps a whole column.
  for (; giver < blocks_; giver = next_large(giver + 1)) table[giver] = {1.0f, static_cast<std::uint32_t>(giver)};
}

double BlockAlias::weight(int x, int y) const {
  return pixel_weight(rgb_.pixel(x, y), floor_);
}

BlockAlias::Draw BlockAlias::draw(int y, double u) const {
  if (!(row_total(y) > 0)) return {y, -1, u};
  const double scaled = u * blocks_;
  const int index = std::min(static_cast<int>(scaled), blocks_ - 1);
  const double fraction = scaled - index;
  const Column column = table(y)[index];
  // Without a branch, which would be guessed wrong.
  const bool own = fraction < column.share;
  const double begin = own ? 0.0 : column.share, end = own ? column.share : 1.0;
  return {y, own ? index : static_cast<int>(column.other), std::min((fraction - begin) / (end - begin), kBelowOne)};
}

void BlockAlias::prefetch_draw(int y, double u) const {
  __builtin_prefetch(table(y) + std::min(static_cast<int>(u * blocks_), blocks_ - 1));
}

void BlockAlias::prefetch_pixels(const Draw& draw) const {
  const int x0 = std::max(draw.block, 0) * kPixelBlock, last = std::min(x0 + kPixelBlock, rgb_.width()) - 1;
  constexpr int kLine = 16;
  for (const float* p = rgb_.pixel(x0, draw.y); p < rgb_.pixel(last, draw.y) + 3; p += kLine) __builtin_prefetch(p);
}

BlockAlias::Place BlockAlias::place_of(int y, double u) const {
  return place_in(draw(y, u));
}

BlockAlias::Place BlockAlias::place_in(const Draw& draw) const {
  if (draw.block < 0) {
    const int x = std::min(static_cast<int>(draw.share * rgb_.width()), rgb_.width() - 1);
    return {x, std::clamp(draw.share * rgb_.width() - x, 0.0, kBelowOne), 0};
  }
  const int x0 = draw.block * kPixelBlock, pixels = std::min(kPixelBlock, rgb_.width() - x0);
  const PixelPlace place = place_of_share(rgb_.pixel(x0, draw.y), pixels, floor_, draw.share);
  return {x0 + place.index, place.inside, place.weight};
}

double BlockAlias::invert(int y, const Place& place) const {
  if (!(row_total(y) > 0)) return std::min((place.x + place.inside) / rgb_.width(), kBelowOne);
  const int block = place.x / kPixelBlock, x0 = block * kPixelBlock;
  double before = 0, all = 0;
  for (int x = x0; x < std::min(x0 + kPixelBlock, rgb_.width()); ++x) {
    if (x < place.x) before += weight(x, y);
    all += weight(x, y);
  }
  const double share = all > 0 ? (before + place.inside * weight(place.x, y)) / all : 0;
  const Column own = table(y)[block];
  if (own.share > 0 || !(all > 0)) return std::min((block + share * own.share) / blocks_, kBelowOne);
  // It gave away all that its own column would hold: in the column of one that it gave to.
  for (int k = 0; k < blocks_; ++k) {
    const Column column = table(y)[k];
    if (static_cast<int>(column.other) == block && column.share < 1)
      return std::min((k + column.share + share * (1.0 - column.share)) / blocks_, kBelowOne);
  }
  return 1.0 * block / blocks_;
}

}  // namespace hdr
