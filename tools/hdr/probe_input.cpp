#include "tools/hdr/probe_input.h"

namespace hdr::tools {

void ProbeInput::declare(CLI::App& app, bool positional) {
  app.add_option(positional ? "probe" : "--probe", path, "a light probe: a map of the sphere")->required();
  app.add_option("--from", from,
                 std::string("its projection (default: its hdr:projection; 2:1 is lat-long): ") + kProjectionNames);
}

Probe ProbeInput::read(Run& run) const {
  ReadMap source = run.stage("read", [&] { return read_map(path); });
  for (const std::string& warning : source.warnings) run.warn(warning);
  Projection projection = projection_of_probe(from, source.map.projection, source.map.size(), path.string());
  return {std::move(source.map), std::move(projection)};
}

}  // namespace hdr::tools
