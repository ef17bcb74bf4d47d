#pragma once
// assimp's materials -> ours. Private to the scene file's reader: assimp's headers are heavy.
#include <assimp/scene.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/render/scene.h"

namespace hdr {

class SceneMaterials {
 public:
  /// What it is given must outlive it; what it leaves out is said in `warnings`.
  SceneMaterials(const aiScene& scene, const Path& path, std::vector<std::string>& warnings);

  struct Read {
    Material material;
    unsigned uv_set = 0;  ///< texcoords of its textures
  };
  Read read(unsigned index);

 private:
  std::shared_ptr<const Texture> texture(const aiMaterial& material, aiTextureType type, TextureMeaning meaning,
                                         unsigned& uv_set);
  std::shared_ptr<const Texture> load(const std::string& name, TextureMeaning meaning);
  Material from_mtl(const aiMaterial& material) const;
  bool is_default(const aiMaterial& material, unsigned index) const;

  const aiScene& scene_;
  Path path_;
  bool gltf_, mtl_;
  std::vector<std::string>& warnings_;
  std::map<std::pair<std::string, TextureMeaning>, std::shared_ptr<const Texture>> loaded_;
};

}  // namespace hdr
