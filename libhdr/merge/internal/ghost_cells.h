#pragma once
// The shots in square cells of a few pixels, on the map's grid: what is compared to find things that moved.
#include <cstdint>
#include <memory>
#include <vector>

#include "libhdr/merge/internal/source.h"

namespace hdr::internal {

/// What a shot says of the cells. Levels are means of linear light (merge_model.h); clipped pixels count as their
/// bound, so a mean with the clipped flag is a lower bound, and one with the black flag is uncertain by black_bound.
struct CellPicture {
  enum Flag : std::uint8_t {
    kClipped = 1,  ///< a pixel of the cell is, of channel c: kClipped << c
    kBlack = 8,    ///< kBlack << c
    kOutside = 64
  };
  std::vector<float> level;         ///< 3 a cell, row by row
  std::vector<std::uint8_t> flags;  ///< 1 a cell
};

/// The grid of cells.
struct CellGrid {
  Size size;     ///< of the map, pixels
  int side = 2;  ///< of a cell, pixels; those of the last row and column may reach beyond the map
  Size cells;    ///< of the grid

  int count() const { return cells.width * cells.height; }
};

/// Cells of two pixels or more, and as large as it takes that there are no more than half a million.
CellGrid cell_grid(Size size);

/// All shots in cells, in one pass over their rows. `model` is one of maximum likelihood: its levels are read. Sources
/// were made with bands of band_height_of(grid) rows.
std::vector<CellPicture> cell_pictures(const CellGrid& grid, const MergeModel& model,
                                       const std::vector<std::unique_ptr<Source>>& sources);
int band_height_of(const CellGrid& grid);

}  // namespace hdr::internal
