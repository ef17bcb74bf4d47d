#pragma once
// The lobes of prefilter.h as functions of the angle from the direction that they blur about.
#include <functional>

#include "libhdr/light/prefilter.h"

namespace hdr {

/// Weight of light at this cosine, 0 below the horizon; not normalised. roughness > 0.
std::function<double(double cosine)> lobe_kernel(Lobe lobe, double roughness);

}  // namespace hdr
