#pragma once
// Precomputed radiance transfer [Sloan02]: what a vertex of a diffuse mesh receives from each spherical harmonic of the
// light, shadows included. Lit by any probe, turned any way, it then costs a sum of products a vertex.
#include <cstdint>
#include <functional>
#include <vector>

#include "libhdr/light/sh.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// Irradiance E = sum of T_k L_k at every vertex: T_k = integral of Y_k(w) V(w) max(n.w, 0), V = 0 where something is
/// in the way.
struct Transfer {
  int degree = 4;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic> vectors;  ///< a row a vertex, (degree + 1)^2 columns
};

struct TransferOptions {
  int degree = 4;
  int samples = 1024;  ///< rays a vertex
  std::uint64_t seed = 1;
  std::function<void(double done)> progress;  ///< 0..1, from any thread
};

/// One for each mesh of the scene; meshes shade each other. What is in the way is estimated by rays (cosine-weighted);
/// without anything in the way the transfer is exact. Same for any number of threads. Meshes need normals: those
/// without get them from with_smooth_normals().
std::vector<Transfer> diffuse_transfer(const Scene& scene, const TransferOptions& options = {});

/// Irradiance of every vertex under a light: a row a vertex, three columns. Bands that one of the two lacks count as 0.
Eigen::Matrix<float, Eigen::Dynamic, 3> relit(const Transfer& transfer, const Sh& light);

/// Rays leave a vertex this far above it.
float transfer_lift(const Mesh& mesh);

/// The mesh with normals, each the mean of its triangles', weighted by their angles. As it is where it has some.
Mesh with_smooth_normals(Mesh mesh);

/// Triangles cut in four until no edge is longer than `longest`: vertices close enough for light to be interpolated.
/// Never above four million triangles.
Mesh tessellated(Mesh mesh, float longest);

}  // namespace hdr
