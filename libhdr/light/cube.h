#pragma once
// The six faces of a cube, as OpenGL, Vulkan and Direct3D number and turn them: +X -X +Y -Y +Z -Z.
#include <array>
#include <functional>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

inline constexpr std::array<const char*, 6> kCubeFaces{"px", "nx", "py", "ny", "pz", "nz"};

/// Unit direction of a face's point; u to the right and v down, both 0..1.
inline Vec3 dir_from_cube_face(int face, double u, double v) {
  const double s = 2 * u - 1, t = 2 * v - 1;
  const std::array<Vec3, 6> dirs{Vec3(1, -t, -s), Vec3(-1, -t, s), Vec3(s, 1, t),
                                 Vec3(s, -1, -t), Vec3(s, -t, 1),  Vec3(-s, -t, -1)};
  return dirs[static_cast<std::size_t>(face)].normalized();
}

/// Six pictures of width x width: f(direction of the pixel's centre).
std::array<Image<float>, 6> cube_map(int width, const std::function<Rgb(const Vec3& dir)>& f);

}  // namespace hdr
