#pragma once
// Where a fisheye's picture ends: the circle that its lens lights on the sensor.
#include <optional>

#include "libhdr/core/image.h"
#include "libhdr/probe/projection.h"

namespace hdr {

struct FoundCircle {
  Disc disc;            ///< may reach beyond the frame
  double support = 0;   ///< share of the rim, of what the frame shows and light reaches, that lies on the circle, 0..1
  double in_frame = 0;  ///< share of the rim that the frame shows, 0..1
  double residual_px = 0;  ///< rms distance of the supporting rim points from the circle
};

/// The lit circle of a fisheye photograph, linear light, one or at least three channels: a dark surround in at least
/// two corners, and within it a rim at which light begins, at half its height. Parts of the rim may be dark or beyond
/// the frame, and lens flare may reach over it. nullopt when the corners are lit or when no circle bounds the light. A
/// circle through three points by consensus [Fischler81], then least squares with Tukey's weights.
std::optional<FoundCircle> find_image_circle(View<const float> picture);

}  // namespace hdr
