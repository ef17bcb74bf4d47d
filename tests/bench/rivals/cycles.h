#pragma once
// Blender's Cycles on the processor, driven by a script: a grey diffuse scene under a lat-long, direct light alone.
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/radiance.h"
#include "libhdr/render/scene.h"

namespace hdr::bench {

struct CyclesRun {
  int samples = 0;
  double cpu_seconds = 0, wall_seconds = 0;  ///< of one render: scene, hierarchy, importance map, sampling, read-back
  RadianceMap picture;
};

/// Whether PATH has `blender`.
bool cycles_is_here();

/// One picture for each number of samples, in one run of Blender. All meshes are taken as diffuse of albedo .5, with
/// their normals, or flat where they have none. Throws Error when Blender fails.
std::vector<CyclesRun> render_by_cycles(const Scene& scene, View<const float> latlong, Size size,
                                        const std::vector<int>& samples, int threads, const Path& scratch);

}  // namespace hdr::bench
