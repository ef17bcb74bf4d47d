#pragma once
#include "tests/bench/bench.h"

namespace hdr::bench {

/// The map that the suites of light work on: --probe at this width, or an invented sky with a sun.
Image<float> light_map(const Bench& bench, int width);
/// How it is called: "an invented sunny sky", or the file's name.
std::string light_name(const Bench& bench);

inline double megapixels(Size size) {
  return 1e-6 * size.width * size.height;
}

}  // namespace hdr::bench
