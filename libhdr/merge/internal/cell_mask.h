#pragma once
// Sets of cells, row by row in a box: what joins, closes and grows them.
#include <cstdint>
#include <functional>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr::internal {

/// 1 for each cell of the set, else 0.
struct CellMask {
  Size size;
  std::vector<std::uint8_t> set;

  explicit CellMask(Size s) : size(s), set(static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height)) {}
};

/// Within `distance` cells of the set, in rows and columns (a square).
CellMask dilated(const CellMask& mask, int distance);
/// Gaps of up to twice `distance` cells are closed. Beyond the border nothing is in the set and nothing is missing.
CellMask closed(const CellMask& mask, int distance);
/// With all cells that the set keeps from the border.
CellMask filled(const CellMask& mask);

/// Connected pieces (by sides and corners), each a list of cells, in the order of their first cell.
std::vector<std::vector<int>> pieces(const CellMask& mask);

/// Cells whose `reach` is `low` or more, in pieces with at least `seeds` cells of which the `evidence` is `high` or
/// more [Canny86]. The two may be one.
CellMask hysteresis(const std::vector<std::uint8_t>& reach, const std::vector<std::uint8_t>& evidence, Size size,
                    int low, int high, int seeds);

}  // namespace hdr::internal
