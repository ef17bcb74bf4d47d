#pragma once
#include "tests/bench/rivals/rival.h"

namespace hdr::bench {

/// OpenCV's AlignMTB with 6 bits (64 pixels), each shot against the middle one.
std::unique_ptr<AlignRival> opencv_align_mtb();

}  // namespace hdr::bench
