#include "libhdr/merge/internal/cell_mask.h"

#include <algorithm>

namespace hdr::internal {
namespace {

/// Largest (or, for an erosion, smallest) of each cell's neighbours along a line of `count` cells `step` apart.
template <class Better>
void along(const std::uint8_t* in, std::uint8_t* out, int count, std::ptrdiff_t step, int distance, Better better) {
  for (int k = 0; k < count; ++k) {
    std::uint8_t best = in[k * step];
    for (int n = std::max(0, k - distance); n <= std::min(count - 1, k + distance); ++n) {
      best = better(best, in[n * step]);
    }
    out[k * step] = best;
  }
}

template <class Better>
CellMask spread(const CellMask& mask, int distance, Better better) {
  CellMask rows(mask.size), out(mask.size);
  const auto [width, height] = mask.size;
  for (int y = 0; y < height; ++y) {
    along(mask.set.data() + y * width, rows.set.data() + y * width, width, 1, distance, better);
  }
  for (int x = 0; x < width; ++x) along(rows.set.data() + x, out.set.data() + x, height, width, distance, better);
  return out;
}

/// Visits the cells that are connected with `first` and not yet `seen`.
void flood(const CellMask& mask, std::uint8_t value, bool corners, int first, std::vector<std::uint8_t>& seen,
           std::vector<int>& piece) {
  const auto [width, height] = mask.size;
  piece.assign(1, first);
  seen[static_cast<std::size_t>(first)] = 1;
  for (std::size_t k = 0; k < piece.size(); ++k) {
    const int x = piece[k] % width, y = piece[k] / width;
    for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
        if (!corners && u != x && v != y) continue;
        const auto cell = static_cast<std::size_t>(v * width + u);
        if (seen[cell] || mask.set[cell] != value) continue;
        seen[cell] = 1;
        piece.push_back(static_cast<int>(cell));
      }
    }
  }
}

}  // namespace

CellMask dilated(const CellMask& mask, int distance) {
  return spread(mask, distance, [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); });
}

CellMask closed(const CellMask& mask, int distance) {
  return spread(dilated(mask, distance), distance, [](std::uint8_t a, std::uint8_t b) { return std::min(a, b); });
}

CellMask filled(const CellMask& mask) {
  const auto [width, height] = mask.size;
  CellMask out = mask;
  std::vector<std::uint8_t> seen(mask.set.size());
  std::vector<int> piece;
  const auto enter = [&](int x, int y) {
    const int cell = y * width + x;
    if (!mask.set[static_cast<std::size_t>(cell)] && !seen[static_cast<std::size_t>(cell)]) {
      flood(mask, 0, false, cell, seen, piece);
    }
  };
  for (int x = 0; x < width; ++x) {
    enter(x, 0);
    enter(x, height - 1);
  }
  for (int y = 0; y < height; ++y) {
    enter(0, y);
    enter(width - 1, y);
  }
  for (std::size_t cell = 0; cell < out.set.size(); ++cell) out.set[cell] = seen[cell] ? 0 : 1;
  return out;
}

std::vector<std::vector<int>> pieces(const CellMask& mask) {
  std::vector<std::vector<int>> all;
  std::vector<std::uint8_t> seen(mask.set.size());
  std::vector<int> piece;
  for (std::size_t cell = 0; cell < mask.set.size(); ++cell) {
    if (!mask.set[cell] || seen[cell]) continue;
    flood(mask, 1, true, static_cast<int>(cell), seen, piece);
    all.push_back(piece);
  }
  return all;
}

CellMask hysteresis(const std::vector<std::uint8_t>& reach, const std::vector<std::uint8_t>& evidence, Size size,
                    int low, int high, int seeds) {
  CellMask mask(size);
  for (std::size_t cell = 0; cell < reach.size(); ++cell) mask.set[cell] = reach[cell] >= low;
  for (const std::vector<int>& piece : pieces(mask)) {
    const auto strong = std::count_if(piece.begin(), piece.end(),
                                      [&](int cell) { return evidence[static_cast<std::size_t>(cell)] >= high; });
    if (strong >= seeds) continue;
    for (const int cell : piece) mask.set[static_cast<std::size_t>(cell)] = 0;
  }
  return mask;
}

}  // namespace hdr::internal
