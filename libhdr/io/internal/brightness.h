#pragma once
// How bright a photograph is, in codes: enough to see whether exposure times can be true.
#include <array>
#include <string>
#include <vector>

#include "libhdr/core/photo_samples.h"

namespace hdr::internal {

/// Quantiles 5 %, 10 %, ... 95 % of the photograph's luma, and its mean, in codes of 255 whatever the bit depth.
struct Brightness {
  static constexpr int kQuantiles = 19;
  std::array<double, kQuantiles> quantiles{};
  double mean = 0;
};

/// Of a photograph whose codes run to `max_code`.
Brightness brightness_of(const PhotoSamples& samples, int max_code);

/// True when `longer` is darker throughout: no quantile above that of `shorter`, and a good part of them clearly below.
bool darker_throughout(const Brightness& longer, const Brightness& shorter);

}  // namespace hdr::internal
