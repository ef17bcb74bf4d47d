#include "libhdr/align/internal/warped_rows.h"

#include <algorithm>
#include <cmath>

namespace hdr::internal {
namespace {

using Taps = std::array<float, 4>;

Taps cubic_taps(double f) {
  const double f2 = f * f, f3 = f2 * f;
  return {static_cast<float>(-0.5 * f + f2 - 0.5 * f3), static_cast<float>(1 - 2.5 * f2 + 1.5 * f3),
          static_cast<float>(0.5 * f + 2 * f2 - 1.5 * f3), static_cast<float>(-0.5 * f2 + 0.5 * f3)};
}

/// The taps at fractions of 1 / kSteps: the rounding moves a pixel by 1 / 2048 at most, and as often left as right.
constexpr int kSteps = 1024;

const std::array<Taps, kSteps + 1>& tap_table() {
  static const std::array<Taps, kSteps + 1> table = [] {
    std::array<Taps, kSteps + 1> made{};
    for (std::size_t k = 0; k <= kSteps; ++k) made[k] = cubic_taps(static_cast<double>(k) / kSteps);
    return made;
  }();
  return table;
}

}  // namespace

WarpedRows::WarpedRows(const LogPicture& b, const Mat3& b_from_a)
    : b_(b),
      motion_(b_from_a / b_from_a(2, 2)),
      affine_(motion_(2, 0) == 0 && motion_(2, 1) == 0),
      whole_rows_(affine_ && motion_.topLeftCorner<2, 2>().isIdentity(0)) {}

void WarpedRows::resample_shifted(int y, int first, int last, float* ln, float* variance) const {
  if (first >= last) return;  // a picture of one column has no inside
  const double tx = motion_(0, 2), ty = motion_(1, 2);
  std::fill(variance + first, variance + last, kUnusable);
  if (!(std::abs(tx) < b_.ln.width() && std::abs(ty) < b_.ln.height())) return;
  const int dx = static_cast<int>(std::floor(tx)), dy = static_cast<int>(std::floor(ty));
  if (y + dy < 1 || y + dy + 2 >= b_.ln.height()) return;
  first = std::max(first, 1 - dx);
  last = std::min(last, b_.ln.width() - 2 - dx);
  if (first >= last) return;
  const Taps taps_x = cubic_taps(tx - dx), taps_y = cubic_taps(ty - dy);
  std::fill(ln + first, ln + last, 0.0f);
  for (int j = 0; j < 4; ++j) {
    const float* row = b_.ln.row(y + dy + j - 1) + dx - 1;
    for (int i = 0; i < 4; ++i) {
      const float tap = taps_y[static_cast<std::size_t>(j)] * taps_x[static_cast<std::size_t>(i)];
      for (int x = first; x < last; ++x) ln[x] += tap * row[x + i];
    }
  }
  // Each variance already speaks for its 3x3 neighbourhood, so the four around speak for all sixteen taps.
  const float *above = b_.variance.row(y + dy) + dx, *below = b_.variance.row(y + dy + 1) + dx;
  for (int x = first; x < last; ++x) {
    variance[x] = std::max(std::max(above[x], above[x + 1]), std::max(below[x], below[x + 1]));
  }
}

void WarpedRows::resample(int y, int first, int last, float* ln, float* variance) const {
  if (whole_rows_) return resample_shifted(y, first, last, ln, variance);
  const std::array<Taps, kSteps + 1>& table = tap_table();
  const double width = b_.ln.width() - 2.0, height = b_.ln.height() - 2.0;
  const double base_x = motion_(0, 1) * y + motion_(0, 2), base_y = motion_(1, 1) * y + motion_(1, 2);
  const double base_w = motion_(2, 1) * y + 1;
  for (int x = first; x < last; ++x) {
    variance[x] = kUnusable;
    ln[x] = 0;
    double px = motion_(0, 0) * x + base_x, py = motion_(1, 0) * x + base_y;
    if (!affine_) {
      const double w = motion_(2, 0) * x + base_w;
      if (!(w > 0.1)) continue;
      px /= w;
      py /= w;
    }
    if (!(px >= 1 && py >= 1 && px < width && py < height)) continue;
    const int x0 = static_cast<int>(px), y0 = static_cast<int>(py);
    const float *above = b_.variance.row(y0) + x0, *below = b_.variance.row(y0 + 1) + x0;
    const float worst = std::max(std::max(above[0], above[1]), std::max(below[0], below[1]));
    if (!(worst < kUnusable)) continue;
    variance[x] = worst;
    const Taps& tx = table[static_cast<std::size_t>((px - x0) * kSteps + 0.5)];
    const Taps& ty = table[static_cast<std::size_t>((py - y0) * kSteps + 0.5)];
    const float* r0 = b_.ln.row(y0 - 1) + x0 - 1;
    const float *r1 = b_.ln.row(y0) + x0 - 1, *r2 = b_.ln.row(y0 + 1) + x0 - 1, *r3 = b_.ln.row(y0 + 2) + x0 - 1;
    float sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += tx[i] * (ty[0] * r0[i] + ty[1] * r1[i] + ty[2] * r2[i] + ty[3] * r3[i]);
    }
    ln[x] = sum;
  }
}

}  // namespace hdr::internal
