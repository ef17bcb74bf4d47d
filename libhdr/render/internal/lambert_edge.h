#pragma once
// How irradiance changes when a point moves past edges that stay where they are.
#include "libhdr/core/vec.h"

namespace hdr {

/// What one edge adds to a polygon's part of the irradiance integral, by Lambert's formula: half the angle under which
/// the edge is seen times the cosine between the surface and the plane through the edge. The sum over the edges of a
/// polygon (counter-clockwise as the surface sees it) is its integral of the cosine over solid angle.
struct LambertEdge {
  double value = 0;
  Vec3 gradient = Vec3::Zero();  ///< by the surface's position
  Mat3 hessian = Mat3::Zero();   ///< likewise
};

/// From the surface with normal n to the ends of the edge.
LambertEdge lambert_edge(const Vec3& a, const Vec3& b, const Vec3& n);

}  // namespace hdr
