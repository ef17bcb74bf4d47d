#pragma once
#include <cstdint>

#include "libhdr/core/image.h"

namespace hdr::test {

/// A seeded scene with `stops` stops of range, smooth gradients, edges and texture: width x height x 3, median near 1.
Image<float> test_scene(int width, int height, double stops, std::uint64_t seed);

}  // namespace hdr::test
