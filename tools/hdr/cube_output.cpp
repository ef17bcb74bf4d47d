#include "tools/hdr/cube_output.h"

#include "libhdr/light/cube.h"
#include "tools/hdr/folder.h"

namespace hdr::tools {

void write_cube(const Path& folder, std::array<Image<float>, 6> faces, const RadianceMap& like,
                const Provenance& provenance, const WriteOptions& options) {
  make_folder(folder);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    RadianceMap map;
    map.rgb = std::move(faces[face]);
    map.chromaticities = like.chromaticities;
    map.white_luminance = like.white_luminance;
    write_map(folder / (std::string(kCubeFaces[face]) + ".exr"), map, provenance, options);
  }
}

}  // namespace hdr::tools
