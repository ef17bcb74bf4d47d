#include "tests/bench/peak_memory.h"

#include <malloc.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace hdr::bench {
namespace {

std::int64_t status_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(key, 0) == 0) return 1024 * std::atoll(line.c_str() + key.size());
  }
  return -1;
}

bool forget_high_water_mark() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5";
  return static_cast<bool>(file.flush());
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);  // freed memory that malloc keeps would be used again, unseen
  if (forget_high_water_mark()) before_ = status_bytes("VmRSS:");
}

std::int64_t PeakMemory::bytes() const {
  const std::int64_t peak = status_bytes("VmHWM:");
  if (before_ < 0 || peak < 0) return -1;
  return peak > before_ ? peak - before_ : 0;
}

}  // namespace hdr::bench
