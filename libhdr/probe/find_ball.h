#pragma once
// Where the mirror ball is in a picture.
#include <optional>

#include "libhdr/core/image.h"
#include "libhdr/probe/projection.h"

namespace hdr {

struct FoundBall {
  Disc disc;
  double support = 0;      ///< share of the outline that an edge supports, 0..1
  double residual_px = 0;  ///< rms distance of the supporting edge points from the circle
};

/// The outline of a sphere in a full frame: edges of log radiance, a voting circle search from coarse to fine, then a
/// robust least-squares circle through sub-pixel edge points. nullopt when no circle has enough support.
std::optional<FoundBall> find_ball(View<const float> rgb);

}  // namespace hdr
