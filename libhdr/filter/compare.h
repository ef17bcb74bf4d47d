#pragma once
// How far apart two maps are (`hdr diff`).
#include <array>
#include <cstdint>

#include "libhdr/core/image.h"

namespace hdr {

enum class CompareScale { kNone, kGlobal, kChannel };

/// Errors of scale * a against b, over samples that are finite in both; logs over samples positive in both. The scale
/// is exp of the median of ln b - ln a. Medians and percentiles are exact: the median of an even number is the mean of
/// the two middle samples, the 99th percentile the smallest sample that 99 % of all do not exceed; 0 without samples.
struct Comparison {
  double rel_rmse = 0;  ///< rms(scale a - b) / rms(b); infinite when b is black and a is not
  double median_abs_log2 = 0;
  double p99_abs_log2 = 0;
  double max_abs = 0;
  std::array<std::int64_t, 2> nonfinite{};
  std::array<double, 3> scale{1, 1, 1};
};

/// Up to three channels. Throws Error when sizes or channels differ. `mask` (one channel, may be empty): samples where
/// it is 0 do not count.
Comparison compare(View<const float> a, View<const float> b, CompareScale scale, View<const std::uint8_t> mask = {});

}  // namespace hdr
