#include "libhdr/align/internal/gauss_newton.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

constexpr int kTile = 32;
constexpr int kSampleStep = 3;  // of the pixels whose residuals are kept for the median
// What is not noise in a residual: texture finer than the pixels, an approximate response. Natural log units.
constexpr double kModelVariance = 0.02 * 0.02;

/// The four taps of Catmull-Rom's cubic at fraction f: through the samples, and third order.
std::array<float, 4> cubic_taps(double f) {
  const double f2 = f * f, f3 = f2 * f;
  return {static_cast<float>(-0.5 * f + f2 - 0.5 * f3), static_cast<float>(1 - 2.5 * f2 + 1.5 * f3),
          static_cast<float>(0.5 * f + 2 * f2 - 1.5 * f3), static_cast<float>(-0.5 * f2 + 0.5 * f3)};
}

/// b resampled at x + t: one shift for all pixels, so the sixteen taps are constants.
class ShiftedRows {
 public:
  ShiftedRows(const LogPicture& b, const Vec2& t)
      : b_(b),
        dx_(static_cast<int>(std::floor(t.x()))),
        dy_(static_cast<int>(std::floor(t.y()))),
        taps_x_(cubic_taps(t.x() - dx_)),
        taps_y_(cubic_taps(t.y() - dy_)) {}

  /// Columns [first_x, last_x) of a whose sixteen neighbours lie in b.
  int first_x() const { return std::max(0, 1 - dx_); }
  int last_x(int width) const { return std::min(width, b_.ln.width() - 2 - dx_); }
  bool covers_row(int y) const { return y + dy_ >= 1 && y + dy_ + 2 < b_.ln.height(); }

  void resample(int y, int first, int last, float* ln, float* variance) const {
    std::fill(ln + first, ln + last, 0.0f);
    for (int j = 0; j < 4; ++j) {
      const float* row = b_.ln.row(y + dy_ + j - 1) + dx_ - 1;
      for (int i = 0; i < 4; ++i) {
        const float tap = taps_y_[static_cast<std::size_t>(j)] * taps_x_[static_cast<std::size_t>(i)];
        for (int x = first; x < last; ++x) ln[x] += tap * row[x + i];
      }
    }
    // Each variance already speaks for its 3x3 neighbourhood, so the four around speak for all sixteen taps.
    const float *above = b_.variance.row(y + dy_) + dx_, *below = b_.variance.row(y + dy_ + 1) + dx_;
    for (int x = first; x < last; ++x) {
      variance[x] = std::max(std::max(above[x], above[x + 1]), std::max(below[x], below[x + 1]));
    }
  }

 private:
  const LogPicture& b_;
  int dx_, dy_;
  std::array<float, 4> taps_x_, taps_y_;
};

/// Sums of products over one tile. A pixel touches two neighbouring knots only, so that part of the Hessian is a band.
struct Products {
  double xx = 0, xy = 0, yy = 0;
  std::array<double, kKnots> x_knot{}, y_knot{}, knot{}, next_knot{};
  Unknowns score = Unknowns::Zero();

  void add_to(Hessian& h) const {
    h(0, 0) += xx;
    h(0, 1) += xy;
    h(1, 0) += xy;
    h(1, 1) += yy;
    for (int k = 0; k < kKnots; ++k) {
      const auto i = static_cast<std::size_t>(k);
      h(0, 2 + k) += x_knot[i];
      h(2 + k, 0) += x_knot[i];
      h(1, 2 + k) += y_knot[i];
      h(2 + k, 1) += y_knot[i];
      h(2 + k, 2 + k) += knot[i];
      if (k + 1 == kKnots) break;
      h(2 + k, 3 + k) += next_knot[i];
      h(3 + k, 2 + k) += next_knot[i];
    }
  }
};

class RowAccumulator {
 public:
  RowAccumulator(const LogPicture& a, const PhotometricMatch& match) : a_(a), match_(match) {}

  void add(int y, int first, int last, const float* ln_b, const float* variance_b, Products& sums,
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
      // dr/d(t_x, t_y, this knot, next knot) = (gx, gy, -to_this, -to_next)
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
      sums.score[0] += gx * wr;
      sums.score[1] += gy * wr;
      sums.score[2 + row] -= to_this * wr;
      sums.score[3 + row] -= to_next * wr;
      if (++part.pixels % kSampleStep == 0) part.magnitudes.push_back(static_cast<float>(magnitude));
    }
  }

 private:
  const LogPicture& a_;
  const PhotometricMatch& match_;
};

void add_tile(Linearization& part, const Products& tile) {
  tile.add_to(part.hessian);
  part.score += tile.score;
  part.tile_scores.push_back(tile.score);
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

Linearization linearize(const LogPicture& a, const LogPicture& b, const Vec2& t, const PhotometricMatch& match) {
  const ShiftedRows shifted(b, t);
  const RowAccumulator rows(a, match);
  const int width = a.ln.width(), height = a.ln.height();
  const int first_x = std::max(1, shifted.first_x()), last_x = shifted.last_x(width - 1);
  const auto one_band = [&](int first, int last) {
    Linearization part;
    if (first_x >= last_x) return part;
    std::vector<Products> tiles(static_cast<std::size_t>(width / kTile + 1));
    std::vector<float> ln(static_cast<std::size_t>(width)), variance(static_cast<std::size_t>(width));
    for (int y = std::max(first, 1); y < std::min(last, height - 1); ++y) {
      if (!shifted.covers_row(y)) continue;
      shifted.resample(y, first_x, last_x, ln.data(), variance.data());
      for (int x = first_x; x < last_x; x = (x / kTile + 1) * kTile) {
        rows.add(y, x, std::min(last_x, (x / kTile + 1) * kTile), ln.data(), variance.data(),
                 tiles[static_cast<std::size_t>(x / kTile)], part);
      }
    }
    for (const Products& tile : tiles) add_tile(part, tile);
    return part;
  };
  return reduce_rows(height, kTile, Linearization{}, one_band, [](Linearization& total, Linearization& part) {
    total.hessian += part.hessian;
    total.score += part.score;
    total.pixels += part.pixels;
    total.tile_scores.insert(total.tile_scores.end(), part.tile_scores.begin(), part.tile_scores.end());
    total.magnitudes.insert(total.magnitudes.end(), part.magnitudes.begin(), part.magnitudes.end());
  });
}

}  // namespace hdr::internal
