#pragma once
// Reading a scene: a name of the built-in set, a file of meshes, or one of `hdr prt`; its camera and its material.
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/render/prt.h"
#include "libhdr/render/scene.h"
#include "libhdr/render/scene_file.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// Normals and axes of a file of meshes.
struct MeshFlags {
  std::string shading = "auto", up = "y";

  void declare(CLI::App& app);
  ReadSceneOptions options() const;
};

/// read_scene(), its warnings passed on, its counts in the answer.
SceneFile read_meshes(Run& run, const std::string& path, const MeshFlags& flags);

/// A camera from flags.
struct CameraFlags {
  std::string eye, look;
  std::optional<double> fov;

  void declare(CLI::App& app);
  /// What the flags say, over what is known; throws Error where it is no camera.
  void apply_to(Camera& camera) const;
};

struct SceneInput {
  std::string scene, material;
  CameraFlags camera;
  MeshFlags mesh;

  void declare(CLI::App& app);

  struct Loaded {
    Scene scene;
    std::vector<Transfer> transfer;  ///< of a .prt file
  };
  /// `picture` is the size of the picture: what framing a mesh depends on.
  Loaded read(Run& run, Size picture) const;
};

}  // namespace hdr::tools
