#pragma once
// Meshes as files have them -> meshes as a tracer wants them.
#include <cstdint>

#include "libhdr/render/scene.h"

namespace hdr {

/// Drops triangles without area (a corner twice, or three in a line), and returns how many. Triangles keep their order.
std::int64_t drop_degenerate(Mesh& mesh);

/// Vertices that are equal to the bit (position, normal, texcoord) become one; they keep their order.
void join_vertices(Mesh& mesh);

/// Normals by the angle-weighted mean of the triangles around a vertex [Thuermer98], of those that meet the triangle at
/// less than `crease_degrees`: sharper edges stay, their vertices doubled.
void smooth_with_creases(Mesh& mesh, double crease_degrees);

}  // namespace hdr
