#include "libhdr/render/internal/scene_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/render/internal/mesh_file_check.h"

namespace hdr {
namespace {

Rgbf color_of(const aiColor4D& color) {
  const Rgbf rgb(color.r, color.g, color.b);
  return rgb.allFinite() ? Rgbf(rgb.max(0.0f).min(1.0f)) : Rgbf(Rgbf::Constant(0.5f));
}

float share_of(float number) {
  return std::isfinite(number) ? std::clamp(number, 0.0f, 1.0f) : 1.0f;
}

Wrap wrap_of(const aiMaterial& material, const char* key, aiTextureType type) {
  int mode = aiTextureMapMode_Wrap;
  material.Get(key, type, 0, mode);
  return mode == aiTextureMapMode_Mirror ? Wrap::kMirror : mode == aiTextureMapMode_Wrap ? Wrap::kRepeat : Wrap::kClamp;
}

}  // namespace

SceneMaterials::SceneMaterials(const aiScene& scene, const Path& path, std::vector<std::string>& warnings)
    : scene_(scene), path_(path), warnings_(warnings) {
  const std::string extension = extension_of(path);
  gltf_ = extension == ".gltf" || extension == ".glb";
  mtl_ = extension == ".obj";
}

// What assimp makes up for meshes that have none: the last of a glTF file, one of that name elsewhere.
bool SceneMaterials::is_default(const aiMaterial& material, unsigned index) const {
  if (gltf_) return index + 1 == scene_.mNumMaterials;
  aiString name;
  return material.Get(AI_MATKEY_NAME, name) != AI_SUCCESS || name == aiString(AI_DEFAULT_MATERIAL_NAME);
}

std::shared_ptr<const Texture> SceneMaterials::load(const std::string& name, TextureMeaning meaning) {
  const auto [found, fresh] = loaded_.try_emplace({name, meaning}, nullptr);
  if (!fresh) return found->second;
  try {
    if (const aiTexture* inside = scene_.GetEmbeddedTexture(name.c_str())) {
      if (inside->mHeight != 0) throw Error(path_.string() + ": a texture in it is not compressed; give it as PNG");
      found->second = std::make_shared<Texture>(
          texture_from_bytes({reinterpret_cast<const unsigned char*>(inside->pcData), inside->mWidth}, meaning,
                             path_.string() + ": texture " + name));
    } else {
      std::string relative = name;
      std::replace(relative.begin(), relative.end(), '\\', '/');
      found->second = std::make_shared<Texture>(read_texture(path_.parent_path() / relative, meaning));
    }
  } catch (const Error& error) {
    warnings_.push_back(fmt::format("{}: left out: {}", path_.string(), error.what()));
  }
  return found->second;
}

std::shared_ptr<const Texture> SceneMaterials::texture(const aiMaterial& material, aiTextureType type,
                                                       TextureMeaning meaning, unsigned& uv_set) {
  aiString name;
  if (material.GetTexture(type, 0, &name) != AI_SUCCESS || name.length == 0) return nullptr;
  int set = 0;
  if (material.Get(AI_MATKEY_UVWSRC(type, 0), set) == AI_SUCCESS && set >= 0) uv_set = static_cast<unsigned>(set);
  const std::shared_ptr<const Texture> shared = load(name.C_Str(), meaning);
  if (!shared) return nullptr;
  const Wrap u = wrap_of(material, _AI_MATKEY_MAPPINGMODE_U_BASE, type),
             v = wrap_of(material, _AI_MATKEY_MAPPINGMODE_V_BASE, type);
  if (u == shared->wrap_u && v == shared->wrap_v) return shared;
  auto own = std::make_shared<Texture>();
  own->texels = shared->texels.clone();
  own->wrap_u = u;
  own->wrap_v = v;
  return own;
}

// Kd is the albedo. Ks and Ns are Phong's, as far as no more light comes back than arrives: exporters that write
// Ks .5 beside any Kd mean something else.
Material SceneMaterials::from_mtl(const aiMaterial& material) const {
  Material result;
  result.roughness = 1;
  aiColor4D diffuse(0.5f, 0.5f, 0.5f, 1), specular(0, 0, 0, 1);
  material.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse);
  material.Get(AI_MATKEY_COLOR_SPECULAR, specular);
  result.color = color_of(diffuse);
  const Rgbf gloss = color_of(specular);
  float exponent = 0;
  material.Get(AI_MATKEY_SHININESS, exponent);
  constexpr float kRounding = 1 + 1e-4f;
  if ((gloss > 0).any() && exponent > 0 && (result.color + gloss <= kRounding).all()) {
    result.kind = MaterialKind::kPhong;
    result.diffuse = result.color;
    result.color = gloss;
    result.exponent = std::min(exponent, 1e5f);
  }
  return result;
}

SceneMaterials::Read SceneMaterials::read(unsigned index) {
  Read read;
  read.material.roughness = 1;
  if (index >= scene_.mNumMaterials) return read;
  const aiMaterial& material = *scene_.mMaterials[index];
  if (is_default(material, index)) return read;
  float metallic = 0, roughness = 1;
  const bool has_metallic = material.Get(AI_MATKEY_METALLIC_FACTOR, metallic) == AI_SUCCESS,
             has_roughness = material.Get(AI_MATKEY_ROUGHNESS_FACTOR, roughness) == AI_SUCCESS;
  aiColor4D base;
  const bool has_base = material.Get(AI_MATKEY_BASE_COLOR, base) == AI_SUCCESS;
  read.material = from_mtl(material);
  if (has_metallic || has_roughness) {
    read.material = {};
    aiColor4D diffuse(0.5f, 0.5f, 0.5f, 1);
    material.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse);
    read.material.kind = MaterialKind::kMetallicRough;
    read.material.color = color_of(has_base ? base : diffuse);
    read.material.metallic = share_of(metallic);
    read.material.roughness = share_of(roughness);
  }
  read.material.color_texture = texture(material, aiTextureType_BASE_COLOR, TextureMeaning::kColor, read.uv_set);
  if (!read.material.color_texture)
    read.material.color_texture = texture(material, aiTextureType_DIFFUSE, TextureMeaning::kColor, read.uv_set);
  if (read.material.kind == MaterialKind::kMetallicRough) {
    unsigned surface_set = read.uv_set;
    read.material.surface_texture = texture(material, aiTextureType_UNKNOWN, TextureMeaning::kNumbers, surface_set);
  }
  return read;
}

}  // namespace hdr
