#pragma once
// Where a camera stood, from a rectangle on the ground that it photographed.
#include <array>
#include <optional>

#include "libhdr/render/scene.h"

namespace hdr {

/// The rectangle lies in y = 0 with its middle in the origin: `width` along X, `depth` along Z. Its corners in the
/// picture (continuous pixels, y down), as the photographer sees them: near left (-X, +Z), near right (+X, +Z), far
/// right (+X, -Z), far left (-X, -Z). The picture is uncropped, its pixels are square.
struct PhotographedRectangle {
  std::array<Vec2, 4> corners;
  double width = 1, depth = 1;
};

struct PlanePose {
  Camera camera;
  double residual_px = 0;  ///< rms distance of the corners from where this camera sees them
};

/// Four points give the pose, and the focal length where `fov_degrees` (horizontal) is not known: the two vanishing
/// points of the rectangle [Zhang00], then least squares over what is unknown. Throws Error when the corners are not
/// those of a rectangle seen from above, or when the field of view does not follow from them (one looks straight down
/// on it, or along a side).
PlanePose pose_from_rectangle(const PhotographedRectangle& seen, Size picture,
                              std::optional<double> fov_degrees = std::nullopt);

}  // namespace hdr
