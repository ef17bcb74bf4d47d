// Materials by name, and with their textures.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "libhdr/render/scene.h"

namespace hdr {
namespace {

constexpr float kNone = -1;  // no number, or a bad one

float number_from_text(const std::string& text, float most) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= 0 && value <= most)) return kNone;
  return value;
}

}  // namespace

Material material_from_text(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  constexpr float kSharpest = 1e5f;  // beyond it, a float direction no longer resolves the lobe
  const bool bare = colon == std::string::npos;
  const float number = bare ? kNone : number_from_text(text.substr(colon + 1), kind == "phong" ? kSharpest : 1);
  const bool good = bare || number >= 0;
  const auto or_else = [&](float value) { return bare ? value : number; };
  Material material;
  if (kind == "diffuse" && good) {
    material.color = Rgbf::Constant(or_else(0.5f));
    material.roughness = 1;
  } else if (kind == "ggx" && good) {
    material = {MaterialKind::kGgx, Rgbf::Constant(0.9f), or_else(0.3f)};
  } else if (kind == "phong" && good) {
    material = {MaterialKind::kPhong, Rgbf::Constant(0.9f), 1, or_else(50)};
  } else if (kind == "mirror" && bare) {
    material = {MaterialKind::kMirror, Rgbf::Constant(1), 0};
  } else {
    throw Error(
        fmt::format("{}: not a material; say diffuse:ALBEDO, ggx:ROUGHNESS (numbers from 0 to 1), phong:EXPONENT (0 to "
                    "100000) or mirror",
                    text));
  }
  return material;
}

Material material_at(const Mesh& mesh, std::uint32_t triangle, const std::array<float, 3>& weights) {
  const Material& whole = mesh.material;
  Material here = whole;
  here.color_texture = here.surface_texture = nullptr;
  if (mesh.texcoords.empty() || (!whole.color_texture && !whole.surface_texture)) return here;
  Vec2f uv = Vec2f::Zero();
  for (std::size_t k = 0; k < 3; ++k) uv += weights[k] * mesh.texcoords[mesh.indices[3 * std::size_t{triangle} + k]];
  if (whole.color_texture) here.color *= whole.color_texture->at(uv);
  if (whole.surface_texture) {
    const Rgbf numbers = whole.surface_texture->at(uv);
    here.roughness *= numbers[1];
    here.metallic *= numbers[2];
  }
  return here;
}

}  // namespace hdr
