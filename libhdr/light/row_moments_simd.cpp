// row_moments on vectors. The eight pixels of a row whose azimuths are delta and -delta from the middles of the four
// quarters see the same |cos m delta|, |sin m delta|: they are added with their signs first (the first steps of a fast
// Fourier transform), and an eighth of the products is left. With pixels a, b, c, d of the four quarters, at azimuths
// psi + delta - k pi/2, psi = 3 pi/4, and the sums of f(delta) + f(-delta) times cos m delta, f(delta) - f(-delta)
// times sin m delta:
//   m = 0, 4, 8 ...:  f = a + b + c + d      m = 2, 6 ...:  f = a - b + c - d
//   m odd:  f = a - c, and f = b - d a quarter turn behind.
// These are moments about the middle of the first quarter: they are turned by m psi once a row.
#include <hwy/cache_control.h>

#include <algorithm>
#include <vector>

#include "libhdr/light/internal/row_moments.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/light/row_moments_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using VD = hn::Vec<D>;
using F = hn::Rebind<float, D>;
constexpr D d64;
constexpr F f32;
constexpr int kLanes = 8;  // of the widest vector
// Columns of an eighth of a row that are dealt with together: what is folded, its part of the table and the sums stay
// in the first cache. In short rows the sums are a larger part of it.
constexpr int kBlock = 64, kShortBlock = 32, kShortRow = 256;
constexpr int kRows = 2;  // that use this part of the table one after the other

// f(delta) + f(-delta) and f(delta) - f(-delta), three channels, of a block.
struct Plane {
  HWY_ALIGN double even[3][kBlock];
  HWY_ALIGN double odd[3][kBlock];
};
struct Folded {
  Plane all, alternating, across, aside;
};

// Sums about the middle of a quarter, still a vector each: f times cos m delta and f times sin m delta of the three
// channels, one wave after the other. No wider than the machine's vectors: with what is folded and the table's part
// they stay in the first cache.
struct alignas(8 * kLanes) Lanes {
  double of[kLanes];
};
class Sums {
 public:
  explicit Sums(int waves)
      : lanes_(static_cast<std::ptrdiff_t>(hn::Lanes(d64))), data_(static_cast<std::size_t>(6 * waves)) {}
  void clear() { std::fill(data_.begin(), data_.end(), Lanes{}); }
  double* wave(int m) { return data_[0].of + 6 * lanes_ * m; }
  double* cosine(int m, int c) { return wave(m) + c * lanes_; }
  double* sine(int m, int c) { return wave(m) + (3 + c) * lanes_; }

 private:
  std::ptrdiff_t lanes_;
  std::vector<Lanes> data_;
};

// Three channels of as many pixels as a vector has lanes.
struct Pixels {
  hn::Vec<F> channel[3];
};

HWY_INLINE Pixels load(const float* p) {
  Pixels pixels;
  hn::LoadInterleaved3(f32, p, pixels.channel[0], pixels.channel[1], pixels.channel[2]);
  return pixels;
}

HWY_INLINE VD near_of(const Pixels& pixels, int c) {
  return hn::PromoteTo(d64, pixels.channel[c]);
}

HWY_INLINE VD far_of(const Pixels& pixels, int c) {
  return hn::PromoteTo(d64, hn::Reverse(f32, pixels.channel[c]));
}

// Fewer columns than a vector has lanes, filled up with black.
HWY_NOINLINE void load_last(const float* p, const float* mirrored, int left, Pixels& near, Pixels& far) {
  const int lanes = static_cast<int>(hn::Lanes(d64));
  HWY_ALIGN float padded[2][3 * kLanes] = {};
  std::copy_n(p, 3 * left, padded[0]);
  std::copy_n(mirrored, 3 * left, padded[1] + 3 * (lanes - left));
  near = load(padded[0]);
  far = load(padded[1]);
}

HWY_INLINE void store(VD near, VD far, int c, int x, Plane& out) {
  hn::Store(hn::Add(near, far), d64, out.even[c] + x);
  hn::Store(hn::Sub(near, far), d64, out.odd[c] + x);
}

// `count` columns from p on and the columns that mirror them, which end at `mirrored`; quarters lie `quarter` columns
// apart.
HWY_INLINE void fold(const float* p, const float* mirrored, std::ptrdiff_t quarter, int count, bool all_planes,
                     Folded& out) {
  const int lanes = static_cast<int>(hn::Lanes(d64));
  for (int x = 0; x < count; x += lanes) {
    Pixels near[4], far[4];
    for (int k = 0; k < 4; ++k) {
      if (x + lanes <= count) {
        near[k] = load(p + 3 * (x + k * quarter));
        far[k] = load(mirrored + 3 * (k * quarter - x - lanes));
      } else {
        load_last(p + 3 * (x + k * quarter), mirrored + 3 * (k * quarter - count), count - x, near[k], far[k]);
      }
    }
    for (int c = 0; c < 3; ++c) {
      const VD a = near_of(near[0], c), b = near_of(near[1], c);
      const VD ac_minus = hn::Sub(a, near_of(near[2], c)), ac = hn::Add(a, near_of(near[2], c));
      const VD bd_minus = hn::Sub(b, near_of(near[3], c)), bd = hn::Add(b, near_of(near[3], c));
      const VD far_a = far_of(far[0], c), far_b = far_of(far[1], c);
      const VD far_ac_minus = hn::Sub(far_a, far_of(far[2], c)), far_ac = hn::Add(far_a, far_of(far[2], c));
      const VD far_bd_minus = hn::Sub(far_b, far_of(far[3], c)), far_bd = hn::Add(far_b, far_of(far[3], c));
      store(hn::Add(ac, bd), hn::Add(far_ac, far_bd), c, x, out.all);
      if (!all_planes) continue;
      store(hn::Sub(ac, bd), hn::Sub(far_ac, far_bd), c, x, out.alternating);
      store(ac_minus, far_ac_minus, c, x, out.across);
      store(bd_minus, far_bd_minus, c, x, out.aside);
    }
  }
}

// The products of one plane with the waves of `kWaves` numbers m, m + step ...: what was loaded serves them all.
template <int kWaves>
HWY_INLINE void add(const Plane& plane, const AzimuthTable& table, int m, int step, int first, int count,
                    double* const* sums) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d64));
  VD cos_sum[kWaves][3], sin_sum[kWaves][3];
  for (int k = 0; k < kWaves; ++k) {
    for (int c = 0; c < 3; ++c) {
      cos_sum[k][c] = hn::Load(d64, sums[k] + c * lanes);
      sin_sum[k][c] = hn::Load(d64, sums[k] + (3 + c) * lanes);
    }
  }
  for (int x = 0; x < count; x += static_cast<int>(hn::Lanes(d64))) {
    VD even[3], odd[3];
    for (int c = 0; c < 3; ++c) {
      even[c] = hn::Load(d64, plane.even[c] + x);
      odd[c] = hn::Load(d64, plane.odd[c] + x);
    }
    for (int k = 0; k < kWaves; ++k) {
      const VD cos_x = hn::LoadU(d64, table.cosines(m + k * step) + first + x);
      const VD sin_x = hn::LoadU(d64, table.sines(m + k * step) + first + x);
      for (int c = 0; c < 3; ++c) {
        cos_sum[k][c] = hn::MulAdd(even[c], cos_x, cos_sum[k][c]);
        sin_sum[k][c] = hn::MulAdd(odd[c], sin_x, sin_sum[k][c]);
      }
    }
  }
  for (int k = 0; k < kWaves; ++k) {
    for (int c = 0; c < 3; ++c) {
      hn::Store(cos_sum[k][c], d64, sums[k] + c * lanes);
      hn::Store(sin_sum[k][c], d64, sums[k] + (3 + c) * lanes);
    }
  }
}

// All waves m, m + step ... up to `degree`, two at a time; the sums of m are sums[m].
HWY_INLINE void add_waves(const Plane& plane, const AzimuthTable& table, int m, int step, int first, int count,
                          double* sums) {
  const auto wave = 6 * static_cast<std::ptrdiff_t>(hn::Lanes(d64));
  for (; m + step <= table.degree(); m += 2 * step) {
    double* const two[] = {sums + m * wave, sums + (m + step) * wave};
    add<2>(plane, table, m, step, first, count, two);
  }
  if (m > table.degree()) return;
  double* const one[] = {sums + m * wave};
  add<1>(plane, table, m, step, first, count, one);
}

// Into the caches, before their turn comes: eight pieces of a row are too short for a processor to foresee the next.
// A quarter's two pieces at a time, between products: all at once are more than a processor asks memory for.
struct Next {
  const float *near = nullptr, *far = nullptr;
  std::ptrdiff_t quarter = 0;
  int count = 0;

  HWY_INLINE void fetch(int k) const {
    constexpr int kLine = 16;
    for (int i = 0; i < 3 * count; i += kLine) {
      hwy::Prefetch(near + 3 * k * quarter + i);
      hwy::Prefetch(far + 3 * k * quarter + i);
    }
  }
};

HWY_INLINE Next next_columns(View<const float> rows, int y, int x, int count) {
  const int quarter = rows.width() / 4;
  return {rows.pixel(x, y), rows.pixel(quarter - x - count, y), quarter, count};
}

HWY_INLINE double total_of(VD v) {
  return hn::GetLane(hn::SumOfLanes(d64, v));
}

// cos and sin of m (psi + delta) from those of m delta; of odd m, with what lies a quarter turn behind.
HWY_INLINE void turn(const double* sums, const double* behind, int m, double* moment) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d64));
  const Vec2 first = AzimuthTable::turn(3 * m), second = AzimuthTable::turn(m);
  const VD cos1 = hn::Set(d64, first.x()), sin1 = hn::Set(d64, first.y());
  const VD cos2 = hn::Set(d64, second.x()), sin2 = hn::Set(d64, second.y());
  for (int c = 0; c < 3; ++c) {
    const VD a = hn::Load(d64, sums + c * lanes), b = hn::Load(d64, sums + (3 + c) * lanes);
    VD cosine = hn::NegMulAdd(sin1, b, hn::Mul(cos1, a)), sine = hn::MulAdd(cos1, b, hn::Mul(sin1, a));
    if (m % 2 == 1) {
      const VD p = hn::Load(d64, behind + c * lanes), q = hn::Load(d64, behind + (3 + c) * lanes);
      cosine = hn::Add(cosine, hn::NegMulAdd(sin2, q, hn::Mul(cos2, p)));
      sine = hn::Add(sine, hn::MulAdd(cos2, q, hn::Mul(sin2, p)));
    }
    moment[c] = total_of(cosine);
    moment[3 + c] = total_of(sine);
  }
}

// At most kRows rows. sums: those of the waves of a row, then those of the odd ones a quarter turn behind.
void sum_rows(View<const float> rows, const AzimuthTable& table, Sums& sums) {
  const int quarter = rows.width() / 4, eighth = (quarter + 1) / 2, waves = table.degree() + 1;
  Folded folded;
  const int block = eighth <= kShortRow ? kShortBlock : kBlock;
  const bool spread = table.degree() >= 4;  // with few products there is nothing to spread them over
  for (int x = 0; x < eighth; x += block) {
    const int count = std::min(block, eighth - x);
    for (int y = 0; y < rows.height(); ++y) {
      Next next;
      if (y + 1 < rows.height()) {
        next = next_columns(rows, y + 1, x, count);
      } else if (x + count < eighth) {
        next = next_columns(rows, 0, x + count, std::min(block, eighth - x - count));
      }
      for (int k = 0; !spread && k < 4; ++k) next.fetch(k);
      fold(rows.pixel(x, y), rows.row(y) + 3 * (quarter - x), quarter, count, table.degree() > 0, folded);
      double* of_row = sums.wave(y * 2 * waves);
      if (spread) next.fetch(0);
      add_waves(folded.all, table, 0, 4, x, count, of_row);
      if (spread) next.fetch(1);
      add_waves(folded.alternating, table, 2, 4, x, count, of_row);
      if (spread) next.fetch(2);
      add_waves(folded.across, table, 1, 2, x, count, of_row);
      if (spread) next.fetch(3);
      add_waves(folded.aside, table, 1, 2, x, count, sums.wave((y * 2 + 1) * waves));
    }
  }
}

void RowMoments(View<const float> rows, const AzimuthTable& table, double* moments) {
  const int waves = table.degree() + 1;
  Sums sums(kRows * 2 * waves);
  for (int first = 0; first < rows.height(); first += kRows) {
    const int last = std::min(first + kRows, rows.height());
    sums.clear();
    sum_rows(rows.rows(first, last), table, sums);
    for (int y = first; y < last; ++y) {
      const int of_row = (y - first) * 2 * waves;
      double* of_moments = moments + static_cast<std::ptrdiff_t>(y) * 3 * table.count();
      for (int c = 0; c < 3; ++c) of_moments[c] = total_of(hn::Load(d64, sums.cosine(of_row, c)));
      for (int m = 1; m < waves; ++m)
        turn(sums.wave(of_row + m), sums.wave(of_row + waves + m), m, of_moments + 3 * (2 * m - 1));
    }
  }
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr {
namespace internal {
HWY_EXPORT(RowMoments);
}

void row_moments(View<const float> rows, const AzimuthTable& table, double* moments) {
  HDR_ASSERT(rows.channels() == 3 && rows.width() == table.width());
  if (rows.width() % 4 != 0) return reference::row_moments(rows, table, moments);
  HWY_DYNAMIC_DISPATCH(internal::RowMoments)(rows, table, moments);
}

}  // namespace hdr
#endif
