#pragma once
// What a test render may cost, figure by figure: the time to each error, of each method of the lecture, of large
// meshes.
#include "libhdr/core/image.h"
#include "libhdr/render/render.h"

namespace hdr::bench {

struct RenderTargets {
  const Scene& scene;
  const Image<float>& sunny;
  Size size;
  bool quick = false;
};

/// Prints a line a figure, each with what it must be. Returns whether all were met.
bool bench_targets(const RenderTargets& targets);

/// A mesh of ten million triangles: memory and time of its hierarchy and of a picture.
void bench_triangles(bool quick);

}  // namespace hdr::bench
