#pragma once
#include <cstdint>

#include "libhdr/core/image.h"

namespace hdr::internal {

/// The bilateral filter of a picture of one channel: a mean over `sigma_space` pixels of those that differ by no more
/// than some `sigma_range`, on a grid as coarse as both allow [Chen07].
Image<float> bilateral(View<const float> image, double sigma_space, double sigma_range);

/// [Durand02]: the base layer of log luminance is compressed to a contrast of 5, its detail stays. `stops` as for the
/// other operators: those of metered_stops leave it as it comes.
Image<std::uint8_t> local_tone(View<const float> rgb, double stops, View<const float> alpha);

}  // namespace hdr::internal
