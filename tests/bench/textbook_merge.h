#pragma once
#include "libhdr/core/photo.h"
#include "libhdr/response/response.h"

namespace hdr::bench {

/// [Debevec97] eq. 6 and 4 as they stand, a pixel at a time in double: ln E = sum w(Z)(g(Z) - ln H) / sum w(Z), with
/// w(Z) = min(Z, 255 - Z). Where no shot has a weight: what the shot says that is nearest to having one. 8 bits.
Image<float> textbook_merge(const Bracket& bracket, const Response& response);

}  // namespace hdr::bench
