#pragma once
// Files of meshes -> a scene, through assimp: OBJ with MTL, PLY, glTF 2.0, GLB (and what else it reads).
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// Normals. kAuto: as the file gives them; where it gives none, OBJ is smooth and others show their facets, as glTF
/// demands and other renderers do with PLY. kFlat, kSmooth: whatever the file gives. Smooth is without edges of more
/// than 40 degrees, which stay.
enum class Shading { kAuto, kFlat, kSmooth };

struct ReadSceneOptions {
  Shading shading = Shading::kAuto;
  bool z_up = false;  ///< the file's +Z becomes our +Y (Blender's and many scanners' axes)
};

/// All triangles, in the places that the file's nodes give them. Materials: glTF's base colour, metallic, roughness and
/// their textures; of MTL Kd, map_Kd, Pr, Pm, and Ks with Ns as Phong's where Kd + Ks is 1 at most. Lights, emission
/// and transparency are not read. Meshes without a material are grey .5.
struct SceneFile {
  Scene scene;                                 ///< with the file's first perspective camera, where it has one
  std::optional<double> vertical_fov_degrees;  ///< of that camera; empty: there is none
  std::int64_t triangles = 0;
  std::int64_t degenerate = 0;        ///< triangles without area, dropped
  std::vector<std::string> warnings;  ///< what was left out
};

/// Throws Error: missing, not a mesh, damaged, no triangles, vertices that are not finite numbers.
SceneFile read_scene(const Path& path, const ReadSceneOptions& options = {});

}  // namespace hdr
