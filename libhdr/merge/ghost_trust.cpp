// From the plan's cells to the rows that a merge asks for, and to what is told of them.
#include <algorithm>
#include <cmath>

#include "libhdr/merge/internal/ghost_plan.h"

namespace hdr::internal {

bool GhostPlan::trust_row(std::size_t source, int y, float* out) const {
  const std::vector<std::uint8_t>& cells = trust[source];
  if (cells.empty()) return false;
  const int columns = grid.cells.width, rows = grid.cells.height;
  const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(grid.side) - 0.5f;
  const int top = std::clamp(static_cast<int>(std::floor(v)), 0, rows - 1), bottom = std::min(top + 1, rows - 1);
  const float t = std::clamp(v - static_cast<float>(top), 0.0f, 1.0f);
  const std::uint8_t *above = cells.data() + static_cast<std::ptrdiff_t>(top) * columns,
                     *below = cells.data() + static_cast<std::ptrdiff_t>(bottom) * columns;
  const auto full = [&](const std::uint8_t* row) {
    return std::all_of(row, row + columns, [](std::uint8_t value) { return value == 255; });
  };
  if (full(above) && full(below)) return false;
  for (int x = 0; x < grid.size.width; ++x) {
    const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(grid.side) - 0.5f;
    const int left = std::clamp(static_cast<int>(std::floor(u)), 0, columns - 1),
              right = std::min(left + 1, columns - 1);
    const float s = std::clamp(u - static_cast<float>(left), 0.0f, 1.0f);
    const auto between = [&](const std::uint8_t* row) {
      const auto a = static_cast<float>(row[left]), b = static_cast<float>(row[right]);
      return a + (b - a) * s;  // exactly a where both are
    };
    const float a = between(above), b = between(below);
    out[x] = (a + (b - a) * t) / 255;
  }
  return true;
}

Ghosts GhostPlan::summary(const std::vector<std::size_t>& shots) const {
  Ghosts ghosts;
  ghosts.regions = regions;
  if (regions.empty()) return ghosts;
  const auto shot_of = [&](int source) { return static_cast<int>(shots[static_cast<std::size_t>(source)]); };
  for (GhostRegion& region : ghosts.regions) {
    region.reference = shot_of(region.reference);
    for (int& source : region.left_out) source = shot_of(source);
  }
  ghosts.mask = Image<std::uint8_t>(grid.size, 1);
  std::vector<float> row(static_cast<std::size_t>(grid.size.width));
  std::int64_t touched = 0;
  for (int y = 0; y < grid.size.height; ++y) {
    std::uint8_t* mask = ghosts.mask.row(y);
    for (std::size_t k = 0; k < trust.size(); ++k) {
      if (!trust_row(k, y, row.data())) continue;
      for (int x = 0; x < grid.size.width; ++x) {
        const auto doubt = static_cast<std::uint8_t>(std::lround(255 * (1 - row[static_cast<std::size_t>(x)])));
        mask[x] = std::max(mask[x], doubt);
      }
    }
    touched += std::count_if(mask, mask + grid.size.width, [](std::uint8_t value) { return value > 0; });
  }
  ghosts.share = static_cast<double>(touched) / (static_cast<double>(grid.size.width) * grid.size.height);
  return ghosts;
}

}  // namespace hdr::internal
