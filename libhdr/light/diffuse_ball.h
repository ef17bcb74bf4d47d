#pragma once
// A matt ball as a light meter that faces every way at once: its radiance is albedo / pi times the irradiance of its
// normals.
#include <vector>

#include "libhdr/light/restore_clipped.h"
#include "libhdr/probe/projection.h"

namespace hdr {

struct BallReadings {
  std::vector<MeasuredIrradiance> readings;  ///< in the axes of a probe that the same camera makes of a mirror ball
  long pixels = 0;                           ///< that went into them
  long unusable = 0;                         ///< of the ball, but black or not finite
};

/// pi L / albedo, means over cells of the visible half of the sphere of normals that are equally large, some 450; the
/// rim is left out, where pixels are half background. `ball` is its outline and the camera's distance, as of a mirror
/// ball.
BallReadings read_diffuse_ball(View<const float> rgb, const MirrorBall& ball, const Rgb& albedo = Rgb::Ones());

}  // namespace hdr
