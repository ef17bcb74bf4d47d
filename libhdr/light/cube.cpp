#include "libhdr/light/cube.h"

#include "libhdr/core/parallel.h"

namespace hdr {

std::array<Image<float>, 6> cube_map(int width, const std::function<Rgb(const Vec3& dir)>& f) {
  HDR_ASSERT(width > 0);
  std::array<Image<float>, 6> faces;
  for (int face = 0; face < 6; ++face) {
    Image<float> picture(width, width, 3);
    for_rows(width, 4, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        for (int x = 0; x < width; ++x) {
          const Rgb value = f(dir_from_cube_face(face, (x + 0.5) / width, (y + 0.5) / width));
          for (int c = 0; c < 3; ++c) picture(x, y, c) = static_cast<float>(value[c]);
        }
      }
    });
    faces[static_cast<std::size_t>(face)] = std::move(picture);
  }
  return faces;
}

}  // namespace hdr
