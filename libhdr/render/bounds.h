#pragma once
// The box around a scene.
#include "libhdr/core/vec.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// Around all vertices, used or not. Of none: `low` is above `high`.
struct Bounds {
  Vec3f low, high;
};
Bounds bounds_of(const Scene& scene);

}  // namespace hdr
