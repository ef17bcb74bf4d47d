#pragma once
// Wavefront OBJ text -> a mesh.
#include <string>

#include "libhdr/render/scene.h"

namespace hdr {

/// Vertices (v), normals (vn) where every corner has one, and polygons (f, cut into fans; negative indices count from
/// the end). Everything else is passed over. `source` is the file's name for messages. Throws Error: no triangles, an
/// index that does not exist, numbers that are none.
Mesh mesh_from_obj(const std::string& text, const std::string& source);

}  // namespace hdr
