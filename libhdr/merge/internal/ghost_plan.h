#pragma once
// Which shots are left out where (deghost.h says how that is decided).
#include <memory>
#include <vector>

#include "libhdr/merge/deghost.h"
#include "libhdr/merge/internal/ghost_agreement.h"
#include "libhdr/merge/internal/ghost_cells.h"

namespace hdr::internal {

/// How far each shot is trusted, by cells: 255 fully, 0 not at all.
struct GhostPlan {
  CellGrid grid;
  std::vector<std::vector<std::uint8_t>> trust;  ///< by source; empty: fully everywhere
  std::vector<GhostRegion> regions;              ///< shots as indices of sources

  bool empty() const { return regions.empty(); }
  /// Trust of the pixels of row y, between the cells' middles; 1 exactly where all around is trusted. False, and
  /// nothing written, where the whole row of the shot is.
  bool trust_row(std::size_t source, int y, float* out) const;
  /// With shots[k] for source k.
  Ghosts summary(const std::vector<std::size_t>& shots) const;
};

/// `shots` in rising order of exposure, their ranges found.
GhostPlan plan_ghosts(const CellGrid& grid, const MergeModel& model, const std::vector<CellShot>& shots);

/// Looks at the rows of these shots of the bracket, once. `exposures` by shot; `model` is one of maximum likelihood.
GhostPlan plan_ghosts(const Bracket& bracket, const std::vector<double>& exposures, const Alignment& alignment,
                      const MergeModel& model, const std::vector<std::size_t>& shots);

}  // namespace hdr::internal
