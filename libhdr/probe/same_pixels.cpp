#include "libhdr/probe/internal/same_pixels.h"

#include <cstring>

namespace hdr::internal {

bool same_pixels(View<const float> a, View<const float> b) {
  if (a.size() != b.size() || a.channels() != b.channels()) return false;
  const std::size_t bytes = static_cast<std::size_t>(a.width() * a.channels()) * sizeof(float);
  for (int y = 0; y < a.height(); ++y) {
    if (std::memcmp(a.row(y), b.row(y), bytes) != 0) return false;
  }
  return true;
}

}  // namespace hdr::internal
