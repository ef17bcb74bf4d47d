#pragma once
// A lat-long as cells with their sums: what the methods of lights.h cut the sphere into.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

struct LightCell {
  Rgb light = Rgb::Zero();      ///< integral of L
  Vec3 moment = Vec3::Zero();   ///< integral of (luminance of L) d
  Vec3 middle = Vec3::UnitY();  ///< unit
  double luminance = 0;         ///< of `light`; of a black map, the solid angle, so that it can be cut as a grey one
  double solid_angle = 0;
};

/// Row by row, `size` cells; a cell is a block of whole pixels.
struct LightCells {
  Size size;
  bool black = false;
  std::vector<LightCell> cells;

  const LightCell& operator()(int x, int y) const {
    return cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x)];
  }
  int count() const { return static_cast<int>(cells.size()); }
};

LightCells light_cells(View<const float> latlong, int largest_width);

/// One label a cell, 0 .. n - 1; each label has a cell, n is `count` or the number of cells if that is less.
using Partition = std::vector<std::int32_t>;

Partition cut_by_median(const LightCells& cells, int count);
Partition cut_by_variance(const LightCells& cells, int count);
Partition cut_by_structure(const LightCells& cells, int count);
Partition cut_by_relaxation(const LightCells& cells, int count);

}  // namespace hdr
