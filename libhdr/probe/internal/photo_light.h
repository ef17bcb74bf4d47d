#pragma once
// How bright photographs are against each other.
#include <vector>

#include "libhdr/probe/stitch.h"

namespace hdr::internal {

/// Gains, and when it is asked for the vignetting, of the photographs that are used, from directions that two or more
/// of them show, under Cauchy's loss; `stitch` has their lenses and rotations.
void fit_light(const std::vector<StitchPhoto>& photos, bool vignetting, Stitch& stitch);

}  // namespace hdr::internal
