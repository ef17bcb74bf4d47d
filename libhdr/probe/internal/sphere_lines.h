#pragma once
// Straight lines of the place, as a picture of the sphere shows them: arcs of great circles.
//
// Light changes across a line along the normal of the plane that holds the line and the eye, and that normal is the
// same all along it, however a projection bends the line. So pixels that lie side by side and have one normal are a
// line [Grompone10]'s way: grown from the steepest edges, kept where they are long and narrow.
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

struct SphereLine {
  Vec3 normal;           ///< unit, of the plane through the eye that fits it best
  Vec3 middle;           ///< unit, a direction on it
  double length = 0;     ///< radians
  double deviation = 0;  ///< of the normal about `middle`, radians: how surely the line runs the way it says
};

/// Lines of a lat-long of light (one channel, not negative), the steepest first. `shown`, where it is given, is 0 where
/// the picture shows nothing.
std::vector<SphereLine> lines_on_sphere(View<const float> latlong, View<const float> shown = {});

}  // namespace hdr::internal
