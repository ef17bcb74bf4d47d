#pragma once
#include "tests/bench/rivals/rival.h"

namespace hdr::bench {

/// OpenCV's CalibrateDebevec with 70 samples and lambda 10, its defaults, and MergeDebevec.
std::unique_ptr<Rival> opencv_debevec();

}  // namespace hdr::bench
