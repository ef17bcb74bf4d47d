#pragma once
// The scene before the simulated camera: 8 x 6 patches of known radiance over 16 stops, every other row of them
// coloured.
#include <array>

namespace hdr::sim {

inline constexpr int kPatchColumns = 8, kPatchRows = 6;

/// Linear RGB of a patch, relative: 1 fills the sensor's full well in 10 ms at gain 1.
std::array<float, 3> patch_radiance(int column, int row);

/// The column and row of the patch under a pixel of a picture `width` x `height`.
constexpr int patch_column(int x, int width) {
  return x * kPatchColumns / width;
}
constexpr int patch_row(int y, int height) {
  return y * kPatchRows / height;
}

}  // namespace hdr::sim
