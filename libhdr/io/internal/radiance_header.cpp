#include "libhdr/io/internal/radiance_header.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

namespace hdr::internal {

double radiance_exposure(const Path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string key = "EXPOSURE=";
  double product = 1;
  std::string line;
  while (std::getline(file, line) && !line.empty()) {  // an empty line ends the header
    if (!line.starts_with(key)) continue;
    const double factor = std::strtod(line.c_str() + key.size(), nullptr);
    if (std::isfinite(factor) && factor > 0) product *= factor;
  }
  return product;
}

}  // namespace hdr::internal
