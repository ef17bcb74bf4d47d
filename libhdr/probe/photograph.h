#pragma once
// What a camera sees in a lat-long environment: the radiance picture that response/expose.h then photographs.
#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr {

/// A pinhole view along scene_from_camera * (+Z). Anti-aliased.
Image<float> photograph_view(View<const float> latlong, Size size, double fov_degrees,
                             const Mat3& scene_from_camera = Mat3::Identity());

/// A perfect mirror ball (its outline is ball.disc, camera at ball.distance radii on +Z of the scene rotated by
/// scene_from_probe), before the environment that the same camera sees behind it. `fov_degrees` is the horizontal field
/// of a far camera's backdrop; at a finite distance the disc's radius fixes it. The rim is anti-aliased.
Image<float> photograph_ball(View<const float> latlong, Size size, const MirrorBall& ball, double fov_degrees = 35,
                             const Mat3& scene_from_probe = Mat3::Identity());

}  // namespace hdr
