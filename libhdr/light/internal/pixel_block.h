#pragma once
// Sixteen pixels of a map's row: what they weigh together, and which of them a share of that weight falls into.
#include <algorithm>

#include "libhdr/core/color.h"
#include "libhdr/core/vec.h"

namespace hdr {

inline constexpr int kPixelBlock = 16;
inline constexpr double kBelowOne = 1 - 0x1p-53;

/// Luminance above `floor`.
inline double pixel_weight(const float* p, double floor) {
  return std::max(0.0, luminance<double>(p[0], p[1], p[2]) - floor);
}

/// Weights of the blocks of a row of RGB pixels, the last of which may be shorter; each block is summed for itself, so
/// that small weights are not lost beside large ones. Returns the sum of the row per channel.
Rgb sum_blocks(const float* row, int width, double floor, double* blocks);

struct PixelPlace {
  int index = 0;      ///< in the block: the first pixel whose running sum lies above what was wanted
  double inside = 0;  ///< where that lies in the pixel, 0..1
  double weight = 0;  ///< of the pixel; > 0
};

/// Where `wanted` (>= 0, a weight) lies in a block of 1 to 16 pixels that weigh more than that, or as much to a
/// rounding.
PixelPlace place_in_block(const float* block, int pixels, double floor, double wanted);
/// The same with a share of the block's weight, 0..1.
PixelPlace place_of_share(const float* block, int pixels, double floor, double share);

namespace reference {
Rgb sum_blocks(const float* row, int width, double floor, double* blocks);
PixelPlace place_in_block(const float* block, int pixels, double floor, double wanted);
}  // namespace reference

}  // namespace hdr
