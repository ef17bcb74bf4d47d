#pragma once
// How far an answer is from the truth.
#include <cstdint>

#include "libhdr/response/response.h"
#include "tests/bench/brackets.h"

namespace hdr::bench {

/// Over samples that some shot exposes well, their true level in [.02, .90] of full well: |log2| of the map over the
/// truth, the median ratio of each channel taken out.
struct MapScore {
  double median = 0, p99 = 0;
  double cap = 0;  ///< median value of samples that clip in every shot over the true saturation; NaN: there are none
  std::int64_t bad = 0;  ///< NaN, infinite or negative samples of the whole map
};
/// Every `step`-th pixel in both directions counts for the medians.
MapScore score_map(View<const float> map, const Truth& truth, int step = 1);

/// Rms of g - truth over 8-bit codes 5..250, the mean of a channel taken out (white balance); the mean of the channels.
double response_rms(const Response& fitted, const Response& truth);

}  // namespace hdr::bench
