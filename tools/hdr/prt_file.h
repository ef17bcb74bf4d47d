#pragma once
// mesh.prt: a mesh with its transfer, so that a render need not compute it again.
#include <string>

#include "libhdr/core/photo.h"
#include "libhdr/render/prt.h"

namespace hdr::tools {

struct PrtMesh {
  Mesh mesh;
  Transfer transfer;
};

/// "hdr-prt 1", a line of numbers (vertices, indices, degree), then little-endian 32-bit: positions, normals (x y z),
/// indices, and the vectors, vertex after vertex. Throws Error.
void write_prt(const Path& path, const PrtMesh& prt);
PrtMesh read_prt(const Path& path);

}  // namespace hdr::tools
