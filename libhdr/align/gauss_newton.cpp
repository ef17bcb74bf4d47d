#include "libhdr/align/internal/gauss_newton.h"

#include <algorithm>
#include <cmath>

#include "libhdr/align/internal/warped_rows.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

constexpr int kSampleStep = 3;  // of the pixels whose residuals are kept for the median
// What is not noise in a residual: texture finer than the pixels, an approximate response. Natural log units.
constexpr double kModelVariance = 0.02 * 0.02;

class RowAccumulator {
 public:
  RowAccumulator(const LogPicture& a, const PhotometricMatch& match) : a_(a), match_(match) {}

  void add(int y, int first, int last, const float* ln_b, const float* variance_b, TileSums& sums,
           Linearization& part) const {
    const float *above = a_.ln.row(y - 1), *here = a_.ln.row(y), *below = a_.ln.row(y + 1);
    const float* variance_a = a_.variance.row(y);
    const double inverse_cut = 1 / (3 * match_.scale);  // Geman-McClure's constant: 3 sigma
    const double inverse_step = 1 / match_.step;
    for (int x = first; x < last; ++x) {
      const double variance = static_cast<double>(variance_a[x]) + variance_b[x] + kModelVariance;
      if (!(variance < static_cast<double>(kUnusable))) continue;
      // The match, between the two knots around a.
      const double a = here[x], position = std::clamp((a - match_.first) * inverse_step, 0.0, kKnots - 1.001);
      const auto k = static_cast<std::size_t>(position);
      const double to_next = position - static_cast<double>(k), to_this = 1 - to_next;
      const auto row = static_cast<Eigen::Index>(k);
      const double residual = ln_b[x] - a - to_this * match_.value[row] - to_next * match_.value[row + 1];
      // Geman-McClure: a pixel beyond the cut (moved content, a ghost of compression) fades out of the sum.
      const double magnitude = std::abs(residual) / std::sqrt(variance), outlying = magnitude * inverse_cut;
      const double fade = 1 / (1 + outlying * outlying);
      const double weight = fade * fade / variance;
      const double gx = 0.5 * (here[x + 1] - here[x - 1]), gy = 0.5 * (below[x] - above[x]);
      // dr/d(e_x, e_y, this knot, next knot) = (gx, gy, -to_this, -to_next)
      const double wx = weight * gx, wy = weight * gy, wr = weight * residual;
      sums.xx += wx * gx;
      sums.xy += wx * gy;
      sums.yy += wy * gy;
      sums.x_knot[k] -= wx * to_this;
      sums.x_knot[k + 1] -= wx * to_next;
      sums.y_knot[k] -= wy * to_this;
      sums.y_knot[k + 1] -= wy * to_next;
      sums.knot[k] += weight * to_this * to_this;
      sums.knot[k + 1] += weight * to_next * to_next;
      sums.next_knot[k] += weight * to_this * to_next;
      sums.shift_score.x() += gx * wr;
      sums.shift_score.y() += gy * wr;
      sums.knot_score[row] -= to_this * wr;
      sums.knot_score[row + 1] -= to_next * wr;
      sums.noise += weight * kGradientNoise * variance_a[x];
      ++sums.pixels;
      if (++part.pixels % kSampleStep == 0) part.magnitudes.push_back(static_cast<float>(magnitude));
    }
  }

 private:
  const LogPicture& a_;
  const PhotometricMatch& match_;
};

/// From gradients in pixels of the picture to displacements in pixels of the photograph.
void rescale(TileSums& tile, double cell) {
  for (double* second : {&tile.xx, &tile.xy, &tile.yy, &tile.noise}) *second /= cell * cell;
  for (std::size_t k = 0; k < kKnots; ++k) {
    tile.x_knot[k] /= cell;
    tile.y_knot[k] /= cell;
  }
  tile.shift_score /= cell;
}

}  // namespace

double Linearization::median_magnitude() {
  if (magnitudes.empty()) return 0;
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return *middle;
}

PhotometricMatch unmatched(const LogPicture& a) {
  float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
  for (int y = 0; y < a.ln.height(); ++y) {
    for (int x = 0; x < a.ln.width(); ++x) {
      if (!a.usable(x, y)) continue;
      low = std::min(low, a.ln(x, y));
      high = std::max(high, a.ln(x, y));
    }
  }
  PhotometricMatch match;
  if (low >= high) return match;
  match.first = low;
  match.step = (static_cast<double>(high) - low) / (kKnots - 1);
  return match;
}

int tile_side(Size size) {
  // Wider than what noise and interpolation correlate; enough of them to tell their scatter.
  return std::clamp(std::min(size.width, size.height) / 12, 8, 32);
}

Linearization linearize(const LogPicture& a, const LogPicture& b, const Mat3& b_from_a, const PhotometricMatch& match) {
  const WarpedRows warped(b, motion_of_cells(b_from_a, a.cell));
  const RowAccumulator rows(a, match);
  const int width = a.ln.width(), height = a.ln.height(), side = tile_side(a.ln.size());
  const auto one_band = [&](int first, int last) {
    Linearization part;
    std::vector<TileSums> tiles(static_cast<std::size_t>(width / side + 1));
    std::vector<float> ln(static_cast<std::size_t>(width)), variance(static_cast<std::size_t>(width));
    for (int y = std::max(first, 1); y < std::min(last, height - 1); ++y) {
      warped.resample(y, 1, width - 1, ln.data(), variance.data());
      for (int x = 1; x < width - 1; x = (x / side + 1) * side) {
        rows.add(y, x, std::min(width - 1, (x / side + 1) * side), ln.data(), variance.data(),
                 tiles[static_cast<std::size_t>(x / side)], part);
      }
    }
    for (std::size_t k = 0; k < tiles.size(); ++k) {
      if (tiles[k].pixels == 0) continue;
      rescale(tiles[k], a.cell);
      const double left = static_cast<double>(k) * side, right = std::min<double>(left + side, width);
      tiles[k].middle = a.cell * Vec2(0.5 * (left + right), 0.5 * (first + last)) - Vec2(0.5, 0.5);
      part.tiles.push_back(tiles[k]);
    }
    return part;
  };
  return reduce_rows(height, side, Linearization{}, one_band, [](Linearization& total, Linearization& part) {
    total.pixels += part.pixels;
    total.tiles.insert(total.tiles.end(), part.tiles.begin(), part.tiles.end());
    total.magnitudes.insert(total.magnitudes.end(), part.magnitudes.begin(), part.magnitudes.end());
  });
}

}  // namespace hdr::internal
