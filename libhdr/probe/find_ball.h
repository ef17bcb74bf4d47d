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

/// The outline of a mirrored sphere in a full frame of linear radiance: edges vote for circles (Hough), and the circle
/// wins along which the reflection's crowding towards the rim shows (probe/internal/outline.h); it is then placed from
/// coarse to fine. nullopt when no circle has that evidence. Where a plain wall meets its own reflection the outline
/// cannot be seen, and the circle is less sure than residual_px says.
std::optional<FoundBall> find_ball(View<const float> rgb);

}  // namespace hdr
