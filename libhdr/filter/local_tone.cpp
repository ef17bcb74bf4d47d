#include "libhdr/filter/internal/local_tone.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/filter/internal/display.h"
#include "libhdr/filter/internal/quantile.h"
#include "libhdr/filter/tonemap.h"

namespace hdr::internal {
namespace {

/// Sums and counts of pixels by place and value; homogeneous, so that blurring and reading divide once, at the end.
class BilateralGrid {
 public:
  BilateralGrid(Size size, double sigma_space, float low, float high, double sigma_range)
      : space_(sigma_space), range_(sigma_range), low_(low) {
    // Two cells of margin: a Gaussian of one cell, cut there, stays inside.
    nx_ = static_cast<int>(size.width / space_) + 1 + 2 * kMargin + 1;
    ny_ = static_cast<int>(size.height / space_) + 1 + 2 * kMargin + 1;
    nz_ = static_cast<int>((high - low) / range_) + 1 + 2 * kMargin + 1;
    cells_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) * static_cast<std::size_t>(nz_), {});
  }

  void add(int x, int y, float value) {
    Cell& cell = at(nearest((x + 0.5) / space_), nearest((y + 0.5) / space_), nearest((value - low_) / range_));
    cell.sum += value;
    cell.count += 1;
  }

  void blur() {
    blur_along(1, nx_);
    blur_along(nx_, ny_);
    blur_along(static_cast<std::ptrdiff_t>(nx_) * ny_, nz_);
  }

  /// Trilinear.
  double read(int x, int y, float value) const {
    const double p[3] = {(x + 0.5) / space_ + kMargin, (y + 0.5) / space_ + kMargin, (value - low_) / range_ + kMargin};
    const int i = static_cast<int>(p[0]), j = static_cast<int>(p[1]), k = static_cast<int>(p[2]);
    double sum = 0, count = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
      const double weight =
          (a ? p[0] - i : 1 - p[0] + i) * (b ? p[1] - j : 1 - p[1] + j) * (c ? p[2] - k : 1 - p[2] + k);
      const Cell& cell = at(i + a, j + b, k + c);
      sum += weight * cell.sum;
      count += weight * cell.count;
    }
    return count > 0 ? sum / count : value;
  }

 private:
  static constexpr int kMargin = 2;
  struct Cell {
    double sum = 0, count = 0;
  };

  static int nearest(double cell) { return static_cast<int>(std::lround(cell)) + kMargin; }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(ny_) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(nx_) +
           static_cast<std::size_t>(i);
  }
  Cell& at(int i, int j, int k) { return cells_[index(i, j, k)]; }
  const Cell& at(int i, int j, int k) const { return cells_[index(i, j, k)]; }

  /// A binomial of five cells, which is a Gaussian of one.
  void blur_along(std::ptrdiff_t step, int count) {
    std::vector<Cell> blurred(cells_.size());
    const auto size = static_cast<std::ptrdiff_t>(cells_.size());
    static constexpr double kWeights[5] = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
    for (std::ptrdiff_t i = 0; i < size; ++i) {
      const auto place = static_cast<int>(i / step % count);
      for (int d = -2; d <= 2; ++d) {
        if (place + d < 0 || place + d >= count) continue;
        const Cell& from = cells_[static_cast<std::size_t>(i + d * step)];
        blurred[static_cast<std::size_t>(i)].sum += kWeights[d + 2] * from.sum;
        blurred[static_cast<std::size_t>(i)].count += kWeights[d + 2] * from.count;
      }
    }
    cells_ = std::move(blurred);
  }

  double space_, range_;
  float low_;
  int nx_ = 0, ny_ = 0, nz_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace

Image<float> bilateral(View<const float> image, double sigma_space, double sigma_range) {
  Image<float> out(image.size(), 1);
  float low = image(0, 0), high = low;
  for (int y = 0; y < image.height(); ++y) {
    const auto [least, most] = std::minmax_element(image.row(y), image.row(y) + image.width());
    low = std::min(low, *least);
    high = std::max(high, *most);
  }
  BilateralGrid grid(image.size(), sigma_space, low, high, sigma_range);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) grid.add(x, y, image(x, y));
  }
  grid.blur();
  for_rows(image.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < image.width(); ++x) out(x, y) = static_cast<float>(grid.read(x, y, image(x, y)));
    }
  });
  return out;
}

Image<std::uint8_t> local_tone(View<const float> rgb, double stops, View<const float> alpha) {
  // [Durand02]: sigmas of 2 % of the picture and 0.4 in log10; a base contrast of 5.
  constexpr double kSpace = 0.02, kRange = 0.4, kContrast = 5, kDarkest = 1e-6;
  const double white = luminance_quantile(rgb, 1);
  if (!(white > 0))
    return displayed(rgb, alpha, [](int, int, const float*, double* out) { out[0] = out[1] = out[2] = 0; });
  const double floor_value = kDarkest * std::exp2(-metered_stops(rgb));
  Image<float> light(rgb.size(), 1);
  for (int y = 0; y < rgb.height(); ++y) {
    for (int x = 0; x < rgb.width(); ++x) {
      light(x, y) = static_cast<float>(std::log10(std::max(floor_value, pixel_luminance(rgb.pixel(x, y)))));
    }
  }
  const double space = std::max(1.0, kSpace * std::max(rgb.width(), rgb.height()));
  const Image<float> base = bilateral(light, space, kRange);
  float low = base(0, 0), high = low;
  for (int y = 0; y < base.height(); ++y) {
    const auto [least, most] = std::minmax_element(base.row(y), base.row(y) + base.width());
    low = std::min(low, *least);
    high = std::max(high, *most);
  }
  const double compression = high > low ? std::min(1.0, std::log10(kContrast) / (high - low)) : 1.0;
  const double brighter = gain_from_stops(stops - metered_stops(rgb));
  return displayed(rgb, alpha, [&](int x, int y, const float* p, double* out) {
    // log output = compressed base + detail, the brightest base being 1.
    const double log_out = (base(x, y) - high) * compression + (light(x, y) - base(x, y));
    const double gain = brighter * std::pow(10.0, log_out - light(x, y));
    for (int c = 0; c < 3; ++c) out[c] = gain * p[c];
  });
}

}  // namespace hdr::internal
