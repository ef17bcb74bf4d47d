#pragma once
// The six faces of a cube as six files.
#include <string>
#include <vector>

#include "libhdr/core/radiance.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"

namespace hdr::tools {

/// OUT_px.exr, OUT_nx.exr, OUT_py.exr, OUT_ny.exr, OUT_pz.exr, OUT_nz.exr for OUT.exr.
std::vector<Path> cube_face_paths(const Path& output);

/// Writes the faces, which `strip` has one above the other, each in its file.
void write_cube_faces(const Path& output, const RadianceMap& strip, const Provenance& provenance,
                      const WriteOptions& options);

/// The files that `paths` mean: six of them are faces, and so is one that is not there while the six that
/// write_cube_faces makes of its name are.
bool are_cube_faces(const std::vector<std::string>& paths);

/// The faces one above the other, in the order of their names (px nx py ny pz nz, or posx negx ...), else in the order
/// given: +X -X +Y -Y +Z -Z. Throws Error where they are not six squares of one size.
ReadMap read_cube_faces(const std::vector<std::string>& paths);

}  // namespace hdr::tools
