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
constexpr int kLanes = 8;   // of the widest vector
constexpr int kBlock = 64;  // columns of an eighth: what is folded and its part of the table stay in the first cache
constexpr int kRows = 2;    // that use this part of the table one after the other

// f(delta) + f(-delta) and f(delta) - f(-delta), three channels, of a block.
struct Plane {
  HWY_ALIGN double even[3][kBlock];
  HWY_ALIGN double odd[3][kBlock];
};
struct Folded {
  Plane all, alternating, across, aside;
};

// Sums about the middle of a quarter, still a vector each: f times cos m delta, f times sin m delta, per channel.
struct Turned {
  HWY_ALIGN double cosine[3][kLanes];
  HWY_ALIGN double sine[3][kLanes];
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
                    Turned* const* sums) {
  VD cos_sum[kWaves][3], sin_sum[kWaves][3];
  for (int k = 0; k < kWaves; ++k) {
    for (int c = 0; c < 3; ++c) {
      cos_sum[k][c] = hn::Load(d64, sums[k]->cosine[c]);
      sin_sum[k][c] = hn::Load(d64, sums[k]->sine[c]);
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
      hn::Store(cos_sum[k][c], d64, sums[k]->cosine[c]);
      hn::Store(sin_sum[k][c], d64, sums[k]->sine[c]);
    }
  }
}

// All waves m, m + step ... up to `degree`, two at a time; the sums of m are sums[m].
HWY_INLINE void add_waves(const Plane& plane, const AzimuthTable& table, int m, int step, int first, int count,
                          Turned* sums) {
  for (; m + step <= table.degree(); m += 2 * step) {
    Turned* const two[] = {sums + m, sums + m + step};
    add<2>(plane, table, m, step, first, count, two);
  }
  if (m > table.degree()) return;
  Turned* const one[] = {sums + m};
  add<1>(plane, table, m, step, first, count, one);
}

// Into the caches, before their turn comes: eight pieces of a row are too short for a processor to foresee the next.
HWY_INLINE void fetch(const float* p, int count) {
  constexpr int kLine = 16;
  for (int k = 0; k < 3 * count; k += kLine) hwy::Prefetch(p + k);
}

HWY_INLINE void fetch_columns(View<const float> rows, int y, int x, int count) {
  const int quarter = rows.width() / 4;
  for (int k = 0; k < 4; ++k) {
    fetch(rows.pixel(k * quarter + x, y), count);
    fetch(rows.pixel((k + 1) * quarter - x - count, y), count);
  }
}

HWY_INLINE double total_of(VD v) {
  return hn::GetLane(hn::SumOfLanes(d64, v));
}

// cos and sin of m (psi + delta) from those of m delta; of odd m, with what lies a quarter turn behind.
HWY_INLINE void turn(const Turned& sums, const Turned& behind, int m, double* moment) {
  const Vec2 first = AzimuthTable::turn(3 * m), second = AzimuthTable::turn(m);
  const VD cos1 = hn::Set(d64, first.x()), sin1 = hn::Set(d64, first.y());
  const VD cos2 = hn::Set(d64, second.x()), sin2 = hn::Set(d64, second.y());
  for (int c = 0; c < 3; ++c) {
    const VD a = hn::Load(d64, sums.cosine[c]), b = hn::Load(d64, sums.sine[c]);
    VD cosine = hn::NegMulAdd(sin1, b, hn::Mul(cos1, a)), sine = hn::MulAdd(cos1, b, hn::Mul(sin1, a));
    if (m % 2 == 1) {
      const VD p = hn::Load(d64, behind.cosine[c]), q = hn::Load(d64, behind.sine[c]);
      cosine = hn::Add(cosine, hn::NegMulAdd(sin2, q, hn::Mul(cos2, p)));
      sine = hn::Add(sine, hn::MulAdd(cos2, q, hn::Mul(sin2, p)));
    }
    moment[c] = total_of(cosine);
    moment[3 + c] = total_of(sine);
  }
}

// At most kRows rows. sums: those of the waves of a row, then those of the odd ones a quarter turn behind.
void Sums(View<const float> rows, const AzimuthTable& table, Turned* sums) {
  const int quarter = rows.width() / 4, eighth = (quarter + 1) / 2, waves = table.degree() + 1;
  Folded folded;
  for (int x = 0; x < eighth; x += kBlock) {
    const int count = std::min(kBlock, eighth - x);
    for (int y = 0; y < rows.height(); ++y) {
      if (y + 1 < rows.height()) {
        fetch_columns(rows, y + 1, x, count);
      } else if (x + count < eighth) {
        fetch_columns(rows, 0, x + count, std::min(kBlock, eighth - x - count));
      }
      fold(rows.pixel(x, y), rows.row(y) + 3 * (quarter - x), quarter, count, table.degree() > 0, folded);
      Turned* of_row = sums + y * 2 * waves;
      add_waves(folded.all, table, 0, 4, x, count, of_row);
      add_waves(folded.alternating, table, 2, 4, x, count, of_row);
      add_waves(folded.across, table, 1, 2, x, count, of_row);
      add_waves(folded.aside, table, 1, 2, x, count, of_row + waves);
    }
  }
}

void RowMoments(View<const float> rows, const AzimuthTable& table, double* moments) {
  const int waves = table.degree() + 1;
  std::vector<Turned> sums(static_cast<std::size_t>(kRows * 2 * waves));
  for (int first = 0; first < rows.height(); first += kRows) {
    const int last = std::min(first + kRows, rows.height());
    std::fill(sums.begin(), sums.end(), Turned{});
    Sums(rows.rows(first, last), table, sums.data());
    for (int y = first; y < last; ++y) {
      double* of_row = moments + static_cast<std::ptrdiff_t>(y) * 3 * table.count();
      const Turned* of_waves = sums.data() + (y - first) * 2 * waves;
      for (int c = 0; c < 3; ++c) of_row[c] = total_of(hn::Load(d64, of_waves[0].cosine[c]));
      for (int m = 1; m < waves; ++m) turn(of_waves[m], of_waves[waves + m], m, of_row + 3 * (2 * m - 1));
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
