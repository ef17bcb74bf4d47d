#pragma once
// Drawing one of the pixels of a map's row by alias tables of its blocks.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/light/block_distribution.h"

namespace hdr {

/// As BlockDistribution, by an alias table a row over its blocks of 16 pixels [Walker77, Vose91]: one look instead of
/// two that wait for each other. Fractions are floats of their own, apart from the number that says which column of the
/// table it is, so that a block of the least weight keeps its share. But numbers beside each other no longer give
/// pixels beside each other: what is stratified along u is not stratified along the row.
class BlockAlias {
 public:
  using Place = BlockDistribution::Place;

  BlockAlias() = default;
  BlockAlias(View<const float> rgb, double floor);

  /// The pixel of row y that u in [0,1) is led to; never one of no weight, unless the whole row has none.
  Place place_of(int y, double u) const;
  /// The same in two steps: while some draws wait for the table, and then for pixels, others do so too.
  struct Draw {
    int y;
    int block;
    double share;  ///< of the block's weight, 0..1; of the row's width in a row of no weight
  };
  Draw draw(int y, double u) const;
  Place place_in(const Draw& draw) const;
  void prefetch_draw(int y, double u) const;
  void prefetch_pixels(const Draw& draw) const;

  /// A u that is led to this place (of a block with a share, the one in its own column). 0 in a row of no weight.
  double invert(int y, const Place& place) const;
  double row_total(int y) const { return row_totals_[static_cast<std::size_t>(y)]; }
  double weight(int x, int y) const;
  const Rgb& row_sum(int y) const { return row_sums_[static_cast<std::size_t>(y)]; }

 private:
  struct Column {
    float share;          ///< of the column's own block
    std::uint32_t other;  ///< the block that has the rest
  };
  void make_table(const std::vector<double>& weights, double total, Column* table) const;
  const Column* table(int y) const { return columns_.data() + static_cast<std::ptrdiff_t>(y) * blocks_; }

  View<const float> rgb_;
  double floor_ = 0;
  int blocks_ = 0;
  std::vector<Rgb> row_sums_;
  std::vector<double> row_totals_;
  std::vector<Column> columns_;
};

}  // namespace hdr
