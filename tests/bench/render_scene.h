#pragma once
// What render_bench lights: a mesh that shades itself on a plane, under a sunny or a soft sky. Made here, so that the
// figures need no file; real meshes and maps are taken where they are.
#include <string>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/render/scene.h"

namespace hdr::bench {

/// A folded ball of segments^2 triangles, 63k as a rule, diffuse .5, on a plane of diffuse .5.
Scene folded_ball_on_plane(int segments = 252);
/// Any mesh on the same plane, scaled to the ball's size, cut finer to at least `triangles`.
Scene mesh_on_plane(Mesh mesh, std::size_t triangles);
/// Blue sky with haze, darker ground, a sun of its true size that gives 80 % of the irradiance from above.
Image<float> sunny_sky(int width);

/// The raw rate of Embree's packets, in occlusion rays a CPU second: the rays that `ao` or sun shadows trace from the
/// hits of one camera ray a pixel, tile by tile, ready in memory; nothing but tracing is timed.
struct RawRates {
  double ao = 0, sun = 0;
  double hits = 0;           ///< of one camera ray a pixel
  double build_seconds = 0;  ///< CPU, of the hierarchy
};
RawRates raw_embree_rates(const Scene& scene, Size size, const Vec3f& sun, int rays_a_pixel);

/// Root of the mean of (x - r)^2 / (r^2 + .01 mean(r)^2) over fully covered pixels and channels.
double rel_rmse(View<const float> picture, View<const float> reference, View<const float> alpha);

}  // namespace hdr::bench
