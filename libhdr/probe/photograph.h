#pragma once
// What a camera sees in a lat-long environment: the radiance picture that response/expose.h then photographs. The scene
// is the lat-long read bilinearly on linear values, so that it is the truth exactly where its pixels are.
#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr {

/// A pinhole view along scene_from_camera * (+Z). Anti-aliased.
Image<float> photograph_view(View<const float> latlong, Size size, double fov_degrees,
                             const Mat3& scene_from_camera = Mat3::Identity());

/// A mirror ball (its outline is ball.disc, camera at ball.distance radii on +Z of the scene rotated by
/// scene_from_probe), before the environment that the same camera sees behind it: its axis through the ball's centre,
/// or through ball.principal, beside which the ball is. `fov_degrees` is the field that a far camera's backdrop has
/// over the picture's width; at a finite distance the disc's radius fixes it. `reflectance` is the ball's at normal
/// incidence (reflectance.h); 1 is a perfect mirror. The rim is anti-aliased: a pixel there is ball and backdrop by the
/// area that each covers.
Image<float> photograph_ball(View<const float> latlong, Size size, const MirrorBall& ball, double fov_degrees = 35,
                             const Mat3& scene_from_probe = Mat3::Identity(), const Rgb& reflectance = Rgb::Ones());

/// Horizontal field, degrees, of the camera of photograph_ball: that of the backdrop.
double fov_of_camera(const MirrorBall& ball, int width, double far_fov_degrees);

}  // namespace hdr
