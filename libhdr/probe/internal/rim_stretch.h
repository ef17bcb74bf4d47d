#pragma once
// Is what a circle holds a mirrored sphere's reflection, or a disc: a lamp, a plate, a wheel, a window, a globe?
//
// At r of the radius a sphere shows the direction at 2 asin(r) from its middle: towards the rim the scene is squeezed
// along the radius by sqrt(1 - r^2) and spread along the ring by its inverse. So what is small and round in the scene
// is 1 / (1 - r^2) times as long along the ring as along the radius, and light changes ever more slowly along the
// rings. A picture behind glass has neither; a painted sphere is squeezed, but not spread; rings and spokes lie one way
// from the middle on. Lengths are compared, not slopes: how steep a scene is at half the length depends on its
// roughness.
#include "libhdr/core/image.h"
#include "libhdr/probe/internal/ball_camera.h"

namespace hdr::internal {

struct RimStretch {
  /// ln of (length along the ring / along the radius) where a sphere's is 2 (r = .93), as a share of that: a sphere has
  /// 1, a painted one 1/2, a picture without direction 0, spokes less.
  double stretch = 0;
  double in_middle = 0;  ///< the same ln, carried on to the middle, where a sphere and a picture have none
  /// How ln |change along the ring| falls with ln 1 / (1 - r^2): a smooth scene's sphere has 1/2, a rough one's less,
  /// anything painted 0.
  double spread = 0;
  double patterned = 0;  ///< share of the change along the radius that is no noise, 0..1, over all rings

  /// Of what a sphere has and nothing painted.
  double mirrored() const { return stretch + spread; }
  /// Likewise, by the lengthening that comes between the middle and the rim: a scene whose own texture lies one way
  /// (clouds, a shore) adds to both alike.
  double mirrored_by_rise() const { return stretch - 0.5 * in_middle + spread; }
};

/// From a picture of luminance (above 0) inside an outline: an ellipse is taken for the circle it is stretched from.
/// `noise`: the standard deviation of a pixel as a share of its value.
RimStretch rim_stretch(View<const float> luminance, const Ellipse& outline, double noise);

/// Whether that is a mirrored sphere's.
bool is_mirrored(const RimStretch& rim);

}  // namespace hdr::internal
