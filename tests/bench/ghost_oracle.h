#pragma once
// What could be reached at best where something moves: by a merge that is told which shots show what in each pixel.
#include <cstdint>
#include <vector>

#include "libhdr/align/align.h"
#include "libhdr/merge/merge.h"
#include "tests/support/movers.h"

namespace hdr::bench {

/// One moment of the scene: without the thing (0), or as shot k - 1 shows it; and for each pixel the set of shots (bit
/// by bit) that show the same as that moment, two pixels around included.
std::vector<std::uint32_t> shots_that_show(const test::MovingScene& scene, std::size_t moment);

struct Oracle {
  double one_moment = 0;  ///< p99 of the best single moment, by all shots that show it: what a person would ask for
  double any_moment =
      0;  ///< of the moment that its shots measure best, for each pixel: no region-wise choice is better
};

/// Errors as test::closest_errors. `options` are those of the merge that is judged.
Oracle oracle_of(const Bracket& bracket, const Alignment& alignment, const test::MovingScene& scene,
                 const test::MoverPlan& plan, MergeOptions options);

}  // namespace hdr::bench
