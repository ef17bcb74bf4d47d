#pragma once
// Interpolation by a cubic B-spline [Unser93] for what has no waves shorter than four pixels: sixteen samples of a
// filtered picture where a windowed sinc as good takes sixty-four of the picture itself.
#include <cstddef>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/probe/internal/neighbourhood.h"

namespace hdr::internal {

/// The spline's coefficients over a box of pixels, three channels. They come from seven samples each way rather than
/// from Unser's recursion, so that a sun reaches no farther than kReach: least squares of the rms error over all phases
/// up to .22 of the sampling rate, constants exact. That error: .005 % at a sixteenth of the sampling rate, .05 % at an
/// eighth, .4 % at a fifth, 1.3 % at a quarter.
class SplineTile {
 public:
  static constexpr int kFilterReach = 3;
  static constexpr float kFilter[kFilterReach + 1] = {1.6874f, -0.4194f, 0.0858f, -0.0101f};
  static constexpr int kReach = 2 + kFilterReach;  ///< samples beyond a position that take part in its value

  static constexpr int kLeastWidth = 4;  ///< of a box

  /// All pixels within kFilterReach of the box must exist.
  void fill(const float* source, std::ptrdiff_t stride, const PixelBox& box);

  /// Of pixel (x, y) of the source, which lies in the box; three floats of the next pixel follow.
  const float* at(int x, int y) const {
    return coefficients_.data() + static_cast<std::ptrdiff_t>(y - box_.first_y) * stride_ +
           3 * static_cast<std::ptrdiff_t>(x - box_.first_x);
  }
  std::ptrdiff_t stride() const { return stride_; }

 private:
  PixelBox box_{};
  std::ptrdiff_t stride_ = 0;
  std::vector<float> coefficients_, row_;
};

/// Whether the spline's error stays below a thousandth of the box's mean: it is .002 to .003 of the fourth difference
/// at all frequencies up to a quarter of the sampling rate, and that is at most a third of the mean along rows and
/// columns. All pixels within two of the box must exist; it is at least SplineTile::kLeastWidth wide. False where the
/// mean is negative.
bool fits_spline(const float* source, std::ptrdiff_t stride, const PixelBox& box);

}  // namespace hdr::internal
