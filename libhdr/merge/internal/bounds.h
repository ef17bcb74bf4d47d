#pragma once
// What can be said of a pixel that no shot measured: only bounds.
#include <array>

#include "libhdr/core/vec.h"

namespace hdr {

/// What the shots say of one channel of a pixel. A shot in which it is clipped says "at least" what saturates that
/// shot; one in which it is black says "about what its black holds, or less".
struct ChannelEvidence {
  float measured = -1;  ///< radiance, when a shot measured it; else negative
  float at_least = 0;   ///< the largest radiance that saturates a shot in which it is clipped; 0: clipped in none
  float at_most = -1;   ///< the smallest radiance of a shot in which it is black; negative: black in none
};

struct ResolvedPixel {
  std::array<float, 3> rgb{};
  bool clipped = false, dark = false;
};

/// Measured channels stay. Clipped ones get their bound, raised to the largest channel of the pixel: the sun is white,
/// not magenta, and a red lamp stays red. Black ones get theirs, lowered to the smallest channel. Between a shot where
/// it is black and one where it is clipped lies the geometric mean of both bounds.
ResolvedPixel resolve_pixel(const std::array<ChannelEvidence, 3>& evidence);

}  // namespace hdr
