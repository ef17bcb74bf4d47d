#pragma once
// Exposure fusion [Mertens07]: a picture for looking straight from the shots, without times, response or radiance.
#include <functional>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr {

/// Exponents of the three measures of quality, as in the paper; 0 leaves one out.
struct FuseOptions {
  double contrast = 1, saturation = 1, exposedness = 1;
};

/// `shot(k)` gives the k-th of `count` registered photographs of one size; each is asked for twice, and one at a time
/// is in memory. The result are codes in [0,1], as the photographs' (mostly sRGB), three channels. Throws Error: no
/// shots, sizes that differ.
Image<float> fuse(int count, const std::function<Photo(int)>& shot, const FuseOptions& options = {});

}  // namespace hdr
