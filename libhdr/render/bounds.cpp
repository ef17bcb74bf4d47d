#include "libhdr/render/bounds.h"

#include <limits>

namespace hdr {

Bounds bounds_of(const Scene& scene) {
  constexpr float kMost = std::numeric_limits<float>::max();
  Bounds box{Vec3f::Constant(kMost), Vec3f::Constant(-kMost)};
  for (const Mesh& mesh : scene.meshes) {
    for (const Vec3f& p : mesh.positions) {
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
  }
  return box;
}

}  // namespace hdr
