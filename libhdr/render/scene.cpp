#include "libhdr/render/scene.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

std::optional<float> share_from_text(const std::string& text) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= 0 && value <= 1)) return std::nullopt;
  return value;
}

}  // namespace

Material material_from_text(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  const std::optional<float> number =
      colon == std::string::npos ? std::nullopt : share_from_text(text.substr(colon + 1));
  const bool number_is_good = colon == std::string::npos || number.has_value();
  if (kind == "diffuse" && number_is_good) return {MaterialKind::kDiffuse, Rgbf::Constant(number.value_or(0.5f)), 1};
  if (kind == "ggx" && number_is_good) return {MaterialKind::kGgx, Rgbf::Constant(0.9f), number.value_or(0.3f)};
  if (kind == "mirror" && colon == std::string::npos) return {MaterialKind::kMirror, Rgbf::Constant(1), 0};
  throw Error(
      fmt::format("{}: not a material; say diffuse:ALBEDO, ggx:ROUGHNESS (numbers from 0 to 1) or mirror", text));
}

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

}  // namespace hdr
