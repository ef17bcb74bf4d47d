// Two shots of a thing that moved by less than its size both show it, in the same colour and about as bright: cell by
// cell they differ by little. But not its texture, which moved along.
#include <algorithm>
#include <cmath>

#include "libhdr/merge/internal/ghost_agreement.h"

namespace hdr::internal {
namespace {

constexpr float kLess = 3;      ///< deviations; cells that differ by more are evidence themselves
constexpr int kHalf = 3;        ///< of a window, cells
constexpr double kFewest = 20;  ///< cells of a window that both shots measure
/// Variance of a texture over that of the noise: below that it may be none.
constexpr double kPlain = 4;
/// Correlation of a texture with itself under that noise is 4/5 or more, of one with another one any other.
constexpr double kLeastCorrelation = 0.5;

/// Sums over cells of the light that two shots show, and of the variance that noise gives their difference.
struct Moments {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0, noise = 0;

  void add(const Moments& m) {
    n += m.n;
    a += m.a;
    b += m.b;
    aa += m.aa;
    bb += m.bb;
    ab += m.ab;
    noise += m.noise;
  }
  bool another_texture() const {
    if (n < kFewest) return false;
    const double of_a = aa - a * a / n, of_b = bb - b * b / n, common = ab - a * b / n;
    return std::min(of_a, of_b) > kPlain * noise && common < kLeastCorrelation * std::sqrt(of_a * of_b);
  }
};

}  // namespace

void PairAgreement::raise_by_texture(const CellBox& box, std::uint8_t value, std::vector<std::uint8_t>& out) const {
  const auto width = static_cast<std::size_t>(box.width());
  std::vector<Moments> rows[2 * kHalf + 1], columns(width);  // three channels of a row after each other
  const auto read = [&](int y, std::vector<Moments>& row) {
    row.assign(3 * width, {});
    if (y < box.y0 || y >= box.y1) return;
    for (std::size_t x = 0; x < width; ++x) {
      const auto cell = static_cast<std::size_t>(y * grid_.cells.width + box.x0) + x;
      Difference channels[3];
      differences(cell, channels);
      const Light light = light_of(cell);
      for (std::size_t c = 0; c < 3; ++c) {
        const Difference& d = channels[c];
        if (!(d.noise > 0) || a_.clipped(cell, c) || b_.clipped(cell, c)) continue;
        if (d.value * d.value > kLess * kLess * (d.noise + d.other)) continue;
        const double a = light.a[c], b = light.b[c];
        row[c * width + x] = {1, a, b, a * a, b * b, a * b, scale_ * scale_ * d.noise + d.shift};
      }
    }
  };
  const auto ring = [&](int y) -> std::vector<Moments>& {
    return rows[(y - box.y0 + 2 * kHalf + 1) % (2 * kHalf + 1)];
  };
  for (int y = box.y0 - kHalf; y < box.y0 + kHalf; ++y) read(y, ring(y));
  for (int y = box.y0; y < box.y1; ++y) {
    read(y + kHalf, ring(y + kHalf));
    std::uint8_t* row = out.data() + static_cast<std::size_t>(y - box.y0) * width;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t x = 0; x < width; ++x) {
        columns[x] = {};
        for (const std::vector<Moments>& of : rows) columns[x].add(of[c * width + x]);
      }
      for (std::size_t x = 0; x < width; ++x) {
        Moments window;
        const std::size_t first = x < kHalf ? 0 : x - kHalf, last = std::min(width, x + kHalf + 1);
        for (std::size_t k = first; k < last; ++k) window.add(columns[k]);
        if (window.another_texture()) row[x] = std::max(row[x], value);
      }
    }
  }
}

}  // namespace hdr::internal
