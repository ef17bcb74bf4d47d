#include "libhdr/merge/internal/bounds.h"

#include <algorithm>
#include <cmath>

namespace hdr {

ResolvedPixel resolve_pixel(const std::array<ChannelEvidence, 3>& evidence) {
  ResolvedPixel pixel;
  float largest = 0, smallest = INFINITY;
  std::array<bool, 3> clipped{}, dark{};
  for (std::size_t c = 0; c < 3; ++c) {
    const ChannelEvidence& e = evidence[c];
    float& value = pixel.rgb[c];
    if (e.measured >= 0) {
      value = e.measured;
    } else if (e.at_least > 0 && e.at_most >= 0) {
      value = std::sqrt(e.at_least) * std::sqrt(e.at_most);
    } else if (e.at_least > 0) {
      value = e.at_least;
      clipped[c] = true;
    } else if (e.at_most >= 0) {
      value = e.at_most;
      dark[c] = true;
    } else {
      continue;  // no shot shows this pixel
    }
    largest = std::max(largest, value);
    smallest = std::min(smallest, value);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    if (clipped[c]) pixel.rgb[c] = largest;
    if (dark[c]) pixel.rgb[c] = smallest;
    pixel.clipped = pixel.clipped || clipped[c];
    pixel.dark = pixel.dark || dark[c];
  }
  return pixel;
}

}  // namespace hdr
