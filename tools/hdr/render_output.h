#pragma once
// What `hdr render` writes: an EXR with layers, another map, or a picture to look at.
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/render/render.h"
#include "tools/hdr/options.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

struct RenderOutput {
  std::string path;
  std::vector<std::string> layers;
  std::optional<double> stops;
  bool transparent = false;
  WriteFlags write;

  void declare(CLI::App& app);
  bool is_picture() const;  ///< .png or .jpg: through the tone mapper
  bool wants(const std::string& layer) const;
  /// Throws what contradicts itself, before anything is rendered.
  void check() const;

  /// `openness`: the picture of RenderMethod::kAo, for the layer `ao`; empty where it is not wanted.
  void save(Run& run, const Rendering& rendering, View<const float> openness, const Provenance& provenance) const;
};

}  // namespace hdr::tools
