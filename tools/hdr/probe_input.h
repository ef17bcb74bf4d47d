#pragma once
// Reading PROBE: a map of the sphere, its projection from --from, its own tag, or its 2:1 shape.
#include <CLI/CLI.hpp>
#include <string>

#include "libhdr/io/read.h"
#include "libhdr/probe/projection.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

struct Probe {
  RadianceMap map;
  Projection projection;
};

struct ProbeInput {
  Path path;
  std::string from;

  /// A positional PROBE, or --probe PROBE where positional is false.
  void declare(CLI::App& app, bool positional);
  Probe read(Run& run) const;
};

}  // namespace hdr::tools
