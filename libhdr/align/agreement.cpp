// Do the pictures show the same thing? A motion that was fitted to another scene has small residuals where both are
// smooth, but gradients that have nothing to do with each other.
#include <algorithm>
#include <array>
#include <cmath>

#include "libhdr/align/internal/gauss_newton.h"
#include "libhdr/align/internal/pair.h"
#include "libhdr/align/internal/warped_rows.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

constexpr double kLeastCorrelation = 0.5;
constexpr std::size_t kFewestTiles = 6;
// Variance of both gradients of binomially smoothed white noise, a share of the noise's: 2 x 0.5 x (6/16)^2 x (1 -
// 1/6).
constexpr double kGradientNoise = 0.117;
constexpr double kTextureOverNoise = 3;

struct GradientSums {
  double ab = 0, aa = 0, bb = 0, noise_a = 0, noise_b = 0;
  int pixels = 0;

  void operator+=(const GradientSums& more) {
    ab += more.ab;
    aa += more.aa;
    bb += more.bb;
    noise_a += more.noise_a;
    noise_b += more.noise_b;
    pixels += more.pixels;
  }
  bool textured() const {
    return aa > kTextureOverNoise * noise_a && bb > kTextureOverNoise * noise_b && aa > 0 && bb > 0;
  }
  double correlation() const { return ab / std::sqrt(aa * bb); }
};

/// Three rows of the warped picture, the newest last.
class RowRing {
 public:
  explicit RowRing(int width)
      : ln_(3, std::vector<float>(static_cast<std::size_t>(width))),
        variance_(3, std::vector<float>(static_cast<std::size_t>(width), kUnusable)) {}
  void push(const WarpedRows& warped, int y, int width) {
    std::rotate(ln_.begin(), ln_.begin() + 1, ln_.end());
    std::rotate(variance_.begin(), variance_.begin() + 1, variance_.end());
    warped.resample(y, 0, width, ln_[2].data(), variance_[2].data());
  }
  const float* ln(std::size_t k) const { return ln_[k].data(); }
  const float* variance(std::size_t k) const { return variance_[k].data(); }

 private:
  std::vector<std::vector<float>> ln_, variance_;
};

void add_row(const LogPicture& a, int y, const RowRing& b, int side, std::vector<GradientSums>& tiles) {
  const float *above = a.ln.row(y - 1), *here = a.ln.row(y), *below = a.ln.row(y + 1), *va = a.variance.row(y);
  for (int x = 1; x + 1 < a.ln.width(); ++x) {
    const float vb = b.variance(1)[x];
    const float around = b.variance(0)[x] + b.variance(2)[x] + b.variance(1)[x - 1] + b.variance(1)[x + 1];
    if (!(va[x] + vb + around < kUnusable)) continue;
    const double ax = 0.5 * (here[x + 1] - here[x - 1]), ay = 0.5 * (below[x] - above[x]);
    const double bx = 0.5 * (b.ln(1)[x + 1] - b.ln(1)[x - 1]), by = 0.5 * (b.ln(2)[x] - b.ln(0)[x]);
    GradientSums& t = tiles[static_cast<std::size_t>(x / side)];
    // Equal weights within a tile: what the pictures show, not how well they show it.
    t.ab += ax * bx + ay * by;
    t.aa += ax * ax + ay * ay;
    t.bb += bx * bx + by * by;
    t.noise_a += 2 * kGradientNoise * va[x];
    t.noise_b += 2 * kGradientNoise * vb;
    ++t.pixels;
  }
}

}  // namespace

std::optional<double> agreement(const LogPicture& a, const LogPicture& b, const Mat3& b_from_a) {
  const int width = a.ln.width(), height = a.ln.height(), side = tile_side(a.ln.size());
  const WarpedRows warped(b, motion_of_cells(b_from_a, a.cell));
  struct Votes {
    std::size_t agree = 0, all = 0;
    GradientSums pooled;
  };
  const auto one_band = [&](int first, int last) {
    std::vector<GradientSums> tiles(static_cast<std::size_t>(width / side + 1));
    RowRing ring(width);
    const int begin = std::max(first, 1), end = std::min(last, height - 1);
    for (int y = begin - 1; y < end + 1 && y < height; ++y) {
      ring.push(warped, y, width);
      if (y > begin) add_row(a, y - 1, ring, side, tiles);
    }
    Votes votes;
    for (const GradientSums& t : tiles) {
      votes.pooled += t;
      if (t.pixels * 4 < side * side || !t.textured()) continue;
      ++votes.all;
      votes.agree += t.correlation() > kLeastCorrelation;
    }
    return votes;
  };
  const Votes votes = reduce_rows(height, side, Votes{}, one_band, [](Votes& total, Votes& part) {
    total.agree += part.agree;
    total.all += part.all;
    total.pooled += part.pooled;
  });
  if (votes.all >= kFewestTiles) return static_cast<double>(votes.agree) / static_cast<double>(votes.all);
  if (!votes.pooled.textured()) return std::nullopt;
  return std::max(0.0, votes.pooled.correlation());
}

}  // namespace hdr::internal
