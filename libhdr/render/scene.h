#pragma once
// What is lit: triangles with materials, and a camera. +Y is up.
#include <cstdint>
#include <string>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

enum class MaterialKind { kDiffuse, kGgx, kMirror };

struct Material {
  MaterialKind kind = MaterialKind::kDiffuse;
  Rgbf color = Rgbf::Constant(0.5f);  ///< albedo, or specular colour at normal incidence
  float roughness = 0.3f;             ///< in [0, 1]; GGX alpha = roughness^2
};

/// "diffuse:0.5", "ggx:0.3", "mirror"; throws Error.
Material material_from_text(const std::string& text);

struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;          ///< smooth, one a position; empty: flat
  std::vector<std::uint32_t> indices;  ///< three a triangle, counter-clockwise seen from outside
  Material material;
};

struct Camera {
  Vec3f eye{0, 1.5f, 6};
  Vec3f look{0, 0.8f, 0};
  double fov_degrees = 40;  ///< horizontal, in (0, 180)
};

struct Scene {
  std::vector<Mesh> meshes;
  Camera camera;
};

Mesh sphere_mesh(const Vec3f& centre, float radius, const Material& material, int segments = 128);
Mesh plane_mesh(float half_size, float y, const Material& material);

/// Diffuse, glossy and mirror spheres on a grey plane.
Scene spheres_on_plane();
/// One unit sphere at the origin, alone.
Scene sphere_alone(const Material& material);

}  // namespace hdr
