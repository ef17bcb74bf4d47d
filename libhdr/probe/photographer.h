#pragma once
// Whoever photographs a mirror ball is in the picture: a figure to stand in simulated scenes.
#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// A copy of a lat-long scene in which a dark figure stands behind the camera, as the ball sees it: shoulders of this
/// half-width (degrees, in (0, 40)) a little below the direction to the camera (+Z of the probe), a head above it, legs
/// and a tripod down to 60 degrees below. Its radiance is 3 % of the scene's mean. Anti-aliased.
Image<float> with_photographer(View<const float> latlong, double half_width_degrees,
                               const Mat3& scene_from_probe = Mat3::Identity());

/// How much of the direction (probe axes) the figure covers: 1 or 0.
bool photographer_covers(const Vec3& probe_dir, double half_width_degrees);

}  // namespace hdr
