#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace hdr::bench {

/// Where the figures come from.
struct Machine {
  std::string processor;                                      ///< "AMD EPYC"
  int cores = 0;                                              ///< that this process may use
  std::int64_t memory_bytes = 0;                              ///< of the machine
  std::string system;                                         ///< "Linux 6.1.0"
  std::vector<std::pair<std::string, std::string>> versions;  ///< of the command, its compiler and its libraries
};

Machine this_machine();

}  // namespace hdr::bench
