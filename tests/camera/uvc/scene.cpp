#include "tests/camera/uvc/scene.h"

#include <cmath>

namespace hdr::sim {

std::array<float, 3> patch_radiance(int column, int row) {
  constexpr float kDarkestLog2 = -10, kStops = 16;
  static constexpr std::array<float, 3> kTints[kPatchRows] = {{1, 1, 1},       {1, 0.6f, 0.4f}, {1, 1, 1},
                                                              {0.5f, 0.8f, 1}, {1, 1, 1},       {0.8f, 1, 0.6f}};
  const int index = row * kPatchColumns + column;
  const float level = std::exp2(kDarkestLog2 + kStops * static_cast<float>(index) / (kPatchColumns * kPatchRows - 1));
  return {level * kTints[row][0], level * kTints[row][1], level * kTints[row][2]};
}

}  // namespace hdr::sim
