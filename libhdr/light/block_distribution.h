#pragma once
// Drawing one of the pixels of a map's row, with the row itself as the table.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// Non-negative weights of the pixels of a map's rows: luminance above `floor`, max(0, Y - floor). Only running sums
/// at the ends of blocks of pixels are kept, in double, and a guide to them [Chen74] that is small enough for a cache;
/// inside a block the pixels themselves are summed again when one is drawn. So building costs one pass over the map,
/// memory a 24th of it, and no pixel that has weight is lost: sums in double tell 2^53 shares apart. A larger u never
/// gives an earlier pixel.
class BlockDistribution {
 public:
  BlockDistribution() = default;
  BlockDistribution(View<const float> rgb, double floor);

  struct Place {
    int x = 0;
    double inside = 0;  ///< where u lies in the pixel, 0..1
    double weight = 0;  ///< of the pixel
  };

  /// The pixel of row y that u in [0,1) falls into; never one of no weight, unless the whole row has none.
  Place place_of(int y, double u) const;
  /// The same in two steps, for many draws at once: each step asks for the memory that the next one reads, which comes
  /// while other draws take theirs. place_of(y, u) is place_in(draw(y, u)).
  struct Draw {
    int y;
    int block;      ///< -1 in a row of no weight
    double inside;  ///< weight of the block before the place; in a row of no weight, the column
  };
  Draw draw(int y, double u) const;
  Place place_in(const Draw& draw) const;
  void prefetch_draw(int y, double u) const;
  void prefetch_pixels(const Draw& draw) const;

  /// The u of a place; of a pixel of no weight, where it would begin. 0 in a row of no weight.
  double invert(int y, const Place& place) const;
  double row_total(int y) const { return row_totals_[static_cast<std::size_t>(y)]; }
  double weight(int x, int y) const;
  /// Sum of the row's pixels, per channel: met on the way.
  const Rgb& row_sum(int y) const { return row_sums_[static_cast<std::size_t>(y)]; }

  static constexpr int kBlock = 16;

 private:
  static constexpr int kCells = 64;  // of a row's guide
  void make_guide(int y);
  struct Range {
    int first, last;
  };
  Range blocks_near(int y, double u) const;
  int block_of(int y, double u, double wanted) const;
  double block_begin(int y, int block) const {
    return block == 0 ? 0 : ends_[static_cast<std::size_t>(y * blocks_ + block - 1)];
  }

  View<const float> rgb_;
  double floor_ = 0;
  int blocks_ = 0;
  std::vector<Rgb> row_sums_;
  std::vector<double> row_totals_;    ///< the last of ends_ of each row, close together: every draw reads one
  std::vector<double> ends_;          ///< of the blocks of every row, from the row's beginning
  std::vector<std::uint16_t> guide_;  ///< a block at or before the one in which a share of k / kCells lies
};

}  // namespace hdr
