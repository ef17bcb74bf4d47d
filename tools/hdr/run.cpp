#include <fmt/format.h>

#include <cstdio>

#include "tools/hdr/verb.h"

namespace hdr::tools {

void Run::say(const std::string& line) const {
  if (!json && !quiet) fmt::print("{}\n", line);
}

void Run::warn(const std::string& line) {
  answer["warnings"].push_back(line);
  if (!quiet) fmt::print(stderr, "warning: {}\n", line);
}

}  // namespace hdr::tools
