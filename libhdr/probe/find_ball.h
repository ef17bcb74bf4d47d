#pragma once
// Where the mirror ball is in a picture.
#include <optional>

#include "libhdr/core/image.h"
#include "libhdr/probe/projection.h"

namespace hdr {

struct FoundBall {
  MirrorBall ball;         ///< with distance and principal point where the field or an elliptic outline gives them
  double support = 0;      ///< share of the outline that an edge supports, 0..1
  double residual_px = 0;  ///< rms distance of the supporting edge points from the outline
};

struct FindBallOptions {
  /// Horizontal field of the whole photograph, degrees, when it is known: fixes the ellipse of a ball beside the
  /// middle, and its distance.
  std::optional<double> fov_degrees{};
};

/// The outline of a mirrored sphere in a full frame of linear radiance: edges vote for circles (Hough), and the circle
/// wins along which the reflection's crowding towards the rim shows (probe/internal/outline.h); it is then placed from
/// coarse to fine. Beside the picture's middle the outline of a near ball is an ellipse that points there: without a
/// known field it is taken for one where that has clearly more evidence. Where no outline has that evidence, as under
/// blur and compression, a circle that nearly fills the frame and along which edges run is taken, to some per cent;
/// nullopt where there is none. A circle that holds no sphere's reflection (probe/internal/rim_stretch.h), as lamps,
/// plates, clocks, flat mirrors and painted balls do not, is no ball; now and then a painted ball or a sign's few bars
/// are taken for one.
/// Where a plain wall meets its own reflection the outline cannot be seen, and it is less sure than residual_px says.
std::optional<FoundBall> find_ball(View<const float> rgb, const FindBallOptions& options = {});

}  // namespace hdr
