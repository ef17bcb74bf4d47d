#pragma once
// What the suites that render have in common: a scene, its light, and how far a picture is from the converged one.
#include "libhdr/light/environment.h"
#include "libhdr/render/render.h"
#include "tests/bench/bench.h"

namespace hdr::bench {

/// On a plane, all of it diffuse .5: the mesh of --scene, or a folded ball of 63k triangles that shades itself.
Scene lit_scene(const Bench& bench);
std::string scene_name(const Bench& bench);

/// Of light_map(), for multiple importance sampling or for the probe alone.
Environment environment_of(const Bench& bench, int width, bool compensated);

/// In percent, over pixels that the reference covers wholly (tests/bench/render_scene.h). NaN when sizes differ.
double percent_off(const RadianceMap& picture, const RadianceMap& reference);

/// By the method of that name. Error in a build without it.
Rendering rendered(const Scene& scene, const Environment& light, const std::string& method, Size size, int samples,
                   std::uint64_t seed, int depth_maps = 0);

}  // namespace hdr::bench
