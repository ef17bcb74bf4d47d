#pragma once
// An EXR with further layers beside the picture.
#include <span>
#include <string>
#include <vector>

#include "libhdr/io/write.h"

namespace hdr {

/// `samples` has a channel for each name ("normal.X", "depth"), and the map's size. Written as float.
struct Layer {
  std::vector<std::string> channels;
  View<const float> samples;
};

/// write_map() with layers. Throws Error when `path` is not .exr: no other format of ours has layers.
void write_layers(const Path& path, const RadianceMap& map, std::span<const Layer> layers,
                  const Provenance& provenance = {}, const WriteOptions& options = {});

}  // namespace hdr
