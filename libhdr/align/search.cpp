// A first shift that needs no start: every whole shift of two small pictures is tried.
#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/align/internal/pair.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

/// What remains of ln radiance when the mean of the usable pixels around is taken away: broad gradients correlate at
/// any shift and would flatten the peak. `reach` pixels to each side.
LogPicture detail_of(const LogPicture& picture, int reach) {
  const int width = picture.ln.width(), height = picture.ln.height();
  LogPicture detail{Image<float>(width, height, 1), picture.variance.clone(), picture.cell};
  for_rows(height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!picture.usable(x, y)) continue;
        double sum = 0, count = 0;
        for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v) {
          for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u) {
            const double usable = picture.usable(u, v);
            sum += usable * picture.ln(u, v);
            count += usable;
          }
        }
        detail.ln(x, y) = static_cast<float>(picture.ln(x, y) - sum / count);
      }
    }
  });
  return detail;
}

struct Correlation {
  double value = -1;
  int pixels = 0;
};

/// Correlation coefficient of a(x) and b(x + d) over the pixels usable in both: blind to gain and to contrast.
Correlation correlate(const LogPicture& a, const LogPicture& b, int dx, int dy) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  const int first = std::max(0, -dx), last = std::min(a.ln.width(), b.ln.width() - dx);
  for (int y = std::max(0, -dy); y < std::min(a.ln.height(), b.ln.height() - dy); ++y) {
    const float *va = a.variance.row(y), *vb = b.variance.row(y + dy) + dx;
    const float *pa = a.ln.row(y), *pb = b.ln.row(y + dy) + dx;
    for (int x = first; x < last; ++x) {
      if (!(va[x] + vb[x] < kUnusable)) continue;
      const double p = pa[x], q = pb[x];
      n += 1;
      sa += p;
      sb += q;
      saa += p * p;
      sbb += q * q;
      sab += p * q;
    }
  }
  if (n < 3) return {};
  const double spread_a = saa - sa * sa / n, spread_b = sbb - sb * sb / n;
  if (spread_a <= 1e-9 * n || spread_b <= 1e-9 * n) return {-1, static_cast<int>(n)};
  return {(sab - sa * sb / n) / std::sqrt(spread_a * spread_b), static_cast<int>(n)};
}

/// Where the parabola through three values has its top, in [-1/2, 1/2] from the middle one.
double parabola_top(double left, double middle, double right) {
  const double bend = left - 2 * middle + right;
  return bend < 0 ? std::clamp(0.5 * (left - right) / bend, -0.5, 0.5) : 0.0;
}

}  // namespace

std::optional<Vec2> search_shift(const LogPicture& picture_a, const LogPicture& picture_b, int radius) {
  constexpr int kDetail = 4;
  const LogPicture a = detail_of(picture_a, kDetail), b = detail_of(picture_b, kDetail);
  constexpr int kFewestPixels = 24;
  const int side = 2 * radius + 1;
  std::vector<Correlation> table(static_cast<std::size_t>(side * side));
  for_rows(side, 1, [&](int row, int) {
    for (int column = 0; column < side; ++column) {
      table[static_cast<std::size_t>(row * side + column)] = correlate(a, b, column - radius, row - radius);
    }
  });
  const auto at = [&](int dx, int dy) -> const Correlation& {
    return table[static_cast<std::size_t>((dy + radius) * side + dx + radius)];
  };
  int most = 0;
  for (const Correlation& c : table) most = std::max(most, c.pixels);
  if (most < kFewestPixels) return std::nullopt;
  // Few pixels correlate well by chance: a candidate must keep most of the overlap.
  int best_x = 0, best_y = 0;
  double best = -1;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      if (at(dx, dy).pixels < 0.6 * most || at(dx, dy).value <= best) continue;
      best = at(dx, dy).value;
      best_x = dx;
      best_y = dy;
    }
  }
  if (best <= 0) return std::nullopt;
  Vec2 peak(best_x, best_y);
  if (std::abs(best_x) < radius && std::abs(best_y) < radius) {
    peak.x() += parabola_top(at(best_x - 1, best_y).value, best, at(best_x + 1, best_y).value);
    peak.y() += parabola_top(at(best_x, best_y - 1).value, best, at(best_x, best_y + 1).value);
  }
  return Vec2(peak * a.cell);
}

}  // namespace hdr::internal
