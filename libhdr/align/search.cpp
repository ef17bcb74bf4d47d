// A first shift that needs no start: every whole shift of two small pictures is tried.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "libhdr/align/internal/pair.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

struct Usable {
  double sum = 0, count = 0;
  void add(const Usable& more) { sum += more.sum, count += more.count; }
  void subtract(const Usable& less) { sum -= less.sum, count -= less.count; }
};

/// What remains of ln radiance when the mean of the usable pixels around is taken away: broad gradients correlate at
/// any shift and would flatten the peak. `reach` pixels to each side.
LogPicture detail_of(const LogPicture& picture, int reach) {
  const int width = picture.ln.width(), height = picture.ln.height();
  LogPicture detail{Image<float>(width, height, 1), picture.variance.clone(), picture.cell};
  for_rows(height, 48, [&](int first, int last) {
    std::vector<Usable> columns(static_cast<std::size_t>(width));  // of the rows around y
    const auto count_row = [&](int y, double sign) {
      if (y < 0 || y >= height) return;
      for (int x = 0; x < width; ++x) {
        if (picture.usable(x, y)) columns[static_cast<std::size_t>(x)].add({sign * picture.ln(x, y), sign});
      }
    };
    for (int y = first - reach; y < first + reach; ++y) count_row(y, 1);
    for (int y = first; y < last; ++y) {
      count_row(y + reach, 1);
      Usable around;
      for (int x = -reach; x < width; ++x) {
        if (x + reach < width) around.add(columns[static_cast<std::size_t>(x + reach)]);
        if (x < 0) continue;
        if (picture.usable(x, y)) detail.ln(x, y) = static_cast<float>(picture.ln(x, y) - around.sum / around.count);
        if (x >= reach) around.subtract(columns[static_cast<std::size_t>(x - reach)]);
      }
      count_row(y - reach, -1);
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

/// The correlations of all shifts within `radius`.
class ShiftTable {
 public:
  ShiftTable(const LogPicture& a, const LogPicture& b, int radius)
      : radius_(radius), side_(2 * radius + 1), table_(static_cast<std::size_t>(side_ * side_)) {
    for_rows(side_, 1, [&](int row, int) {
      for (int column = 0; column < side_; ++column) {
        table_[static_cast<std::size_t>(row * side_ + column)] = correlate(a, b, column - radius_, row - radius_);
      }
    });
    for (const Correlation& c : table_) most_ = std::max(most_, c.pixels);
  }

  /// How unlikely the correlation is by chance: Fisher's z in its standard deviations. 0 outside the table, and where
  /// little of the overlap is left.
  double significance(int dx, int dy) const {
    if (std::max(std::abs(dx), std::abs(dy)) > radius_) return 0;
    const Correlation& c = table_[static_cast<std::size_t>((dy + radius_) * side_ + dx + radius_)];
    if (c.pixels < kFewestPixels || c.pixels < 0.3 * most_ || c.value <= 0) return 0;
    return std::atanh(std::min(c.value, 0.9999)) * std::sqrt(c.pixels - 3.0);
  }

  double correlation(int dx, int dy) const {
    return significance(dx, dy) > 0 ? table_[static_cast<std::size_t>((dy + radius_) * side_ + dx + radius_)].value : 0;
  }

  bool is_peak(int dx, int dy) const {
    const double here = significance(dx, dy);
    for (int k = 0; k < 9; ++k) {
      if (k != 4 && significance(dx + k % 3 - 1, dy + k / 3 - 1) > here) return false;
    }
    return here > 0;
  }

 private:
  static constexpr int kFewestPixels = 16;
  int radius_, side_;
  std::vector<Correlation> table_;
  int most_ = 0;
};

struct Peak {
  double significance;
  Vec2 shift;  ///< photograph pixels
};

/// The best first.
std::vector<Peak> peaks_of(const LogPicture& a, const LogPicture& b, int radius, std::size_t most) {
  constexpr int kDetail = 4;
  const ShiftTable table(detail_of(a, kDetail), detail_of(b, kDetail), radius);
  std::vector<Peak> peaks;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      if (!table.is_peak(dx, dy)) continue;
      const auto at = [&](int x, int y) { return table.significance(dx + x, dy + y); };
      const Vec2 top(parabola_top(at(-1, 0), at(0, 0), at(1, 0)), parabola_top(at(0, -1), at(0, 0), at(0, 1)));
      peaks.push_back({at(0, 0), (Vec2(dx, dy) + top) * a.cell});
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const Peak& p, const Peak& q) { return p.significance > q.significance; });
  peaks.resize(std::min(peaks.size(), most));
  return peaks;
}

/// What `picture` shows at turn(x), by the nearest pixel: it is only to be recognised.
LogPicture seen_through(const LogPicture& picture, const Mat3& turn) {
  const int width = picture.ln.width(), height = picture.ln.height();
  LogPicture out{Image<float>(width, height, 1), Image<float>(width, height, 1), picture.cell};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec2 p = moved(turn, Vec2(x, y));
      const auto u = static_cast<int>(std::lround(p.x())), v = static_cast<int>(std::lround(p.y()));
      const bool inside = u >= 0 && v >= 0 && u < width && v < height;
      out.ln(x, y) = inside ? picture.ln(u, v) : 0;
      out.variance(x, y) = inside ? picture.variance(u, v) : kUnusable;
    }
  }
  return out;
}

}  // namespace

std::vector<Vec2> search_shifts(const LogPicture& a, const LogPicture& b, int radius, std::size_t most) {
  std::vector<Vec2> shifts;
  for (const Peak& peak : peaks_of(a, b, radius, most)) shifts.push_back(peak.shift);
  return shifts;
}

std::vector<Mat3> search_turns(const LogPicture& a, const LogPicture& b, Size photo, int radius, std::size_t most) {
  constexpr int kMost = 5;  // degrees each way, in steps of one: what is left is for the refinement
  const MotionFrame frame(photo);
  struct Turned {
    double significance;
    Mat3 motion;
  };
  std::vector<Turned> found;
  for (int degrees = -kMost; degrees <= kMost; ++degrees) {
    if (degrees == 0) continue;
    MotionVector small = MotionVector::Zero();
    small[2] = degrees * std::numbers::pi / 180 * frame.radius;
    const Mat3 turn = frame.motion(small);
    for (const Peak& peak : peaks_of(a, seen_through(b, motion_of_cells(turn, b.cell)), radius, 1)) {
      found.push_back({peak.significance, turn * shift_by(peak.shift)});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Turned& p, const Turned& q) { return p.significance > q.significance; });
  std::vector<Mat3> motions;
  for (std::size_t k = 0; k < std::min(found.size(), most); ++k) motions.push_back(found[k].motion);
  return motions;
}

std::vector<Vec2> repeats(const Pyramid& picture, const Vec2& middle) {
  constexpr int kWindow = 64, kRadius = 10, kDetail = 4, kOwnWidth = 2;
  constexpr double kAlike = 0.8;
  std::vector<Vec2> shifts;
  for (const LogPicture& level : picture.levels) {
    const int width = std::min(kWindow, level.ln.width()), height = std::min(kWindow, level.ln.height());
    const int left = std::clamp(static_cast<int>(middle.x() / level.cell) - width / 2, 0, level.ln.width() - width);
    const int top = std::clamp(static_cast<int>(middle.y() / level.cell) - height / 2, 0, level.ln.height() - height);
    LogPicture window{Image<float>(width, height, 1), Image<float>(width, height, 1), level.cell};
    for (int y = 0; y < height; ++y) {
      std::copy_n(level.ln.row(top + y) + left, width, window.ln.row(y));
      std::copy_n(level.variance.row(top + y) + left, width, window.variance.row(y));
    }
    const LogPicture detail = detail_of(window, kDetail);
    const ShiftTable table(detail, detail, kRadius);
    for (int dy = 0; dy <= kRadius; ++dy) {
      for (int dx = dy == 0 ? 1 : -kRadius; dx <= kRadius; ++dx) {
        if (std::max(std::abs(dx), dy) <= kOwnWidth || !table.is_peak(dx, dy)) continue;
        if (table.correlation(dx, dy) > kAlike) shifts.emplace_back(Vec2(dx, dy) * level.cell);
      }
    }
  }
  constexpr std::size_t kMost = 4;  // the shortest: the others are their multiples
  std::stable_sort(shifts.begin(), shifts.end(), [](const Vec2& p, const Vec2& q) { return p.norm() < q.norm(); });
  shifts.resize(std::min(shifts.size(), kMost));
  return shifts;
}

}  // namespace hdr::internal
