#pragma once
// What is lit: triangles with materials, and a camera. +Y is up.
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/render/texture.h"

namespace hdr {

/// kPhong: energy-normalised [Lafortune94], with a diffuse part. kMetallicRough: glTF 2.0's, GGX over diffuse.
enum class MaterialKind { kDiffuse, kGgx, kMirror, kPhong, kMetallicRough };

struct Material {
  MaterialKind kind = MaterialKind::kDiffuse;
  Rgbf color = Rgbf::Constant(0.5f);  ///< albedo, specular colour at normal incidence, or glTF's base colour
  float roughness = 0.3f;             ///< of kGgx and kMetallicRough, in [0, 1]; GGX alpha = roughness^2
  float exponent = 50;                ///< of kPhong, above 0
  Rgbf diffuse = Rgbf::Zero();        ///< of kPhong, beside `color`; their sum is 1 at most
  float metallic = 0;                 ///< of kMetallicRough, in [0, 1]
  bool shadow_catcher = false;        ///< stands for ground that a photograph shows: only what falls on it is seen
  /// Where the mesh has texcoords: multiplies `color`; green multiplies `roughness` and blue `metallic`, as in glTF.
  std::shared_ptr<const Texture> color_texture = nullptr, surface_texture = nullptr;
};

/// "diffuse:0.5", "ggx:0.3", "phong:50", "mirror"; throws Error.
Material material_from_text(const std::string& text);

struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;          ///< smooth, one a position; empty: flat
  std::vector<std::uint32_t> indices;  ///< three a triangle, counter-clockwise seen from outside
  Material material;
  std::vector<Vec2f> texcoords = {};  ///< one a position, (0, 0) in the texture's lower left corner; or empty
};

/// The mesh's material at a point of a triangle, its textures looked up: the result has none.
Material material_at(const Mesh& mesh, std::uint32_t triangle, const std::array<float, 3>& weights);

struct Camera {
  Vec3f eye{0, 1.5f, 6};
  Vec3f look{0, 0.8f, 0};
  double fov_degrees = 40;  ///< horizontal, in (0, 180)
  Vec3f up{0, 1, 0};        ///< at the picture's top
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

/// All meshes as one, with the first one's material, normals where each has some, and no texture.
Mesh joined(const Scene& scene);

}  // namespace hdr
