#include "libhdr/render/scene.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/mesh_tools.h"

namespace hdr {

// Rings of equal polar angle from the top to the bottom, half as many as segments.
Mesh sphere_mesh(const Vec3f& centre, float radius, const Material& material, int segments) {
  HDR_ASSERT(segments >= 3 && radius > 0);
  const int rings = std::max(2, segments / 2);
  Mesh mesh;
  mesh.material = material;
  const auto add_vertex = [&](const Vec3& normal) {
    mesh.normals.push_back(normal.cast<float>());
    mesh.positions.push_back(centre + radius * normal.cast<float>());
  };
  add_vertex({0, 1, 0});
  for (int ring = 1; ring < rings; ++ring) {
    const double polar = kPi * ring / rings;
    for (int i = 0; i < segments; ++i) {
      const double azimuth = 2 * kPi * i / segments;
      add_vertex({std::sin(polar) * std::sin(azimuth), std::cos(polar), std::sin(polar) * std::cos(azimuth)});
    }
  }
  add_vertex({0, -1, 0});

  const auto vertex = [&](int ring, int i) -> std::uint32_t {
    if (ring == 0) return 0;
    if (ring == rings) return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    return static_cast<std::uint32_t>(1 + (ring - 1) * segments + i % segments);
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < segments; ++i) {
      const std::uint32_t a = vertex(ring, i), b = vertex(ring + 1, i), c = vertex(ring + 1, i + 1),
                          d = vertex(ring, i + 1);
      if (ring + 1 < rings) mesh.indices.insert(mesh.indices.end(), {a, b, c});
      if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, c, d});
    }
  }
  return mesh;
}

Mesh plane_mesh(float half_size, float y, const Material& material) {
  Mesh mesh;
  mesh.positions = {
      {-half_size, y, -half_size}, {-half_size, y, half_size}, {half_size, y, half_size}, {half_size, y, -half_size}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = material;
  return mesh;
}

Scene spheres_on_plane() {
  constexpr float kRadius = 0.65f, kApart = 1.4f;
  const Material grey{MaterialKind::kDiffuse, Rgbf::Constant(0.5f), 1};
  const Material gold{MaterialKind::kGgx, Rgbf(1.0f, 0.78f, 0.34f), 0.35f};
  const Material mirror{MaterialKind::kMirror, Rgbf::Constant(0.95f), 0};
  Scene scene;
  scene.meshes.push_back(plane_mesh(8, 0, grey));
  scene.meshes.push_back(sphere_mesh({0, kRadius, kApart}, kRadius, grey));
  scene.meshes.push_back(sphere_mesh({0, kRadius, 0}, kRadius, gold));
  scene.meshes.push_back(sphere_mesh({0, kRadius, -kApart}, kRadius, mirror));
  // Across the axis of a mirror ball's probe: neither the photographer (+Z) nor the blind spot (-Z) is the backdrop.
  scene.camera.eye = {6, 1.5f, 0};
  scene.camera.look = {0, 0.8f, 0};
  return scene;
}

Scene sphere_alone(const Material& material) {
  Scene scene;
  scene.meshes.push_back(sphere_mesh({0, 0, 0}, 1, material));
  scene.camera = {{0, 0, 4.5f}, {0, 0, 0}, 40};
  return scene;
}

Mesh joined(const Scene& scene) {
  Mesh all;
  bool smooth = true;
  for (const Mesh& mesh : scene.meshes) {
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
    for (const std::uint32_t index : mesh.indices) all.indices.push_back(first + index);
    smooth = smooth && !mesh.normals.empty();
  }
  if (!smooth) all.normals.clear();
  if (!scene.meshes.empty()) all.material = scene.meshes[0].material;
  all.material.color_texture = all.material.surface_texture = nullptr;
  join_vertices(all);  // seams of textures are closed
  return all;
}

}  // namespace hdr
