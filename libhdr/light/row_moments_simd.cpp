// row_moments on vectors. The eight pixels of a row whose azimuths are delta and -delta from the middles of the four
// quarters see the same |cos m delta|, |sin m delta|: they are added with their signs first (the first steps of a fast
// Fourier transform), and an eighth of the products is left. With pixels a, b, c, d of the four quarters, at azimuths
// psi + delta - k pi/2, psi = 3 pi/4, and the sums of f(delta) + f(-delta) times cos m delta, f(delta) - f(-delta)
// times sin m delta:
//   m = 0, 4, 8 ...:  f = a + b + c + d      m = 2, 6 ...:  f = a - b + c - d
//   m odd:  f = a - c, and f = b - d a quarter turn behind.
// These are moments about the middle of the first quarter: they are turned by m psi once a row.
#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
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
constexpr int kBlock = 128;  // columns of an eighth: what is folded stays in the first cache

// f(delta) + f(-delta) and f(delta) - f(-delta), three channels, of a block.
struct Plane {
  HWY_ALIGN double even[3][kBlock];
  HWY_ALIGN double odd[3][kBlock];
};
struct Folded {
  Plane all, alternating, across, aside;
};

// Sums about the middle of a quarter: f times cos m delta, f times sin m delta, per channel.
struct Turned {
  double cosine[3] = {}, sine[3] = {};
};

HWY_INLINE void load3(const float* p, VD v[3]) {
  hn::Vec<F> r, g, b;
  hn::LoadInterleaved3(f32, p, r, g, b);
  v[0] = hn::PromoteTo(d64, r);
  v[1] = hn::PromoteTo(d64, g);
  v[2] = hn::PromoteTo(d64, b);
}

HWY_INLINE void load3_mirrored(const float* p, VD v[3]) {
  hn::Vec<F> r, g, b;
  hn::LoadInterleaved3(f32, p, r, g, b);
  v[0] = hn::PromoteTo(d64, hn::Reverse(f32, r));
  v[1] = hn::PromoteTo(d64, hn::Reverse(f32, g));
  v[2] = hn::PromoteTo(d64, hn::Reverse(f32, b));
}

HWY_INLINE void store(VD near, VD far, int c, int x, Plane& out) {
  hn::Store(hn::Add(near, far), d64, out.even[c] + x);
  hn::Store(hn::Sub(near, far), d64, out.odd[c] + x);
}

// `count` columns from p on and the columns that mirror them, which end at `mirrored`; quarters lie `quarter` columns
// apart. What is left of the last vector is filled with black.
HWY_INLINE void fold(const float* p, const float* mirrored, std::ptrdiff_t quarter, int count, bool all_planes,
                     Folded& out) {
  const int lanes = static_cast<int>(hn::Lanes(d64));
  for (int x = 0; x < count; x += lanes) {
    VD near[4][3], far[4][3];
    for (int k = 0; k < 4; ++k) {
      const float* from = p + 3 * (x + k * quarter);
      const float* back = mirrored + 3 * (k * quarter - x - lanes);
      HWY_ALIGN float padded[2][3 * 8] = {};
      if (x + lanes > count) {
        const int left = count - x;
        std::copy_n(from, 3 * left, padded[0]);
        std::copy_n(mirrored + 3 * (k * quarter - count), 3 * left, padded[1] + 3 * (lanes - left));
        from = padded[0];
        back = padded[1];
      }
      load3(from, near[k]);
      load3_mirrored(back, far[k]);
    }
    for (int c = 0; c < 3; ++c) {
      const VD near_ac = hn::Add(near[0][c], near[2][c]), near_bd = hn::Add(near[1][c], near[3][c]);
      const VD far_ac = hn::Add(far[0][c], far[2][c]), far_bd = hn::Add(far[1][c], far[3][c]);
      store(hn::Add(near_ac, near_bd), hn::Add(far_ac, far_bd), c, x, out.all);
      if (!all_planes) continue;
      store(hn::Sub(near_ac, near_bd), hn::Sub(far_ac, far_bd), c, x, out.alternating);
      store(hn::Sub(near[0][c], near[2][c]), hn::Sub(far[0][c], far[2][c]), c, x, out.across);
      store(hn::Sub(near[1][c], near[3][c]), hn::Sub(far[1][c], far[3][c]), c, x, out.aside);
    }
  }
}

HWY_INLINE double total_of(VD v) {
  return hn::GetLane(hn::SumOfLanes(d64, v));
}

HWY_INLINE void add(const Plane& plane, const double* cosine, const double* sine, int count, Turned& out) {
  VD cos_sum[3] = {hn::Zero(d64), hn::Zero(d64), hn::Zero(d64)}, sin_sum[3] = {cos_sum[0], cos_sum[0], cos_sum[0]};
  for (int x = 0; x < count; x += static_cast<int>(hn::Lanes(d64))) {
    const VD cos_x = hn::LoadU(d64, cosine + x), sin_x = hn::LoadU(d64, sine + x);
    for (int c = 0; c < 3; ++c) {
      cos_sum[c] = hn::MulAdd(hn::Load(d64, plane.even[c] + x), cos_x, cos_sum[c]);
      sin_sum[c] = hn::MulAdd(hn::Load(d64, plane.odd[c] + x), sin_x, sin_sum[c]);
    }
  }
  for (int c = 0; c < 3; ++c) {
    out.cosine[c] += total_of(cos_sum[c]);
    out.sine[c] += total_of(sin_sum[c]);
  }
}

// cos and sin of m (psi + delta) from those of m delta.
HWY_INLINE void turn(const Turned& about_middle, double angle, double* moment) {
  const double cosine = std::cos(angle), sine = std::sin(angle);
  for (int c = 0; c < 3; ++c) {
    moment[c] += cosine * about_middle.cosine[c] - sine * about_middle.sine[c];
    moment[3 + c] += sine * about_middle.cosine[c] + cosine * about_middle.sine[c];
  }
}

void RowMoments(View<const float> rows, const AzimuthTable& table, double* moments) {
  constexpr double kMiddle = 0.75 * kPi;
  const int quarter = rows.width() / 4, eighth = (quarter + 1) / 2;
  Folded folded;
  std::fill_n(moments, static_cast<std::ptrdiff_t>(rows.height()) * 3 * table.count(), 0.0);
  for (int x = 0; x < eighth; x += kBlock) {
    const int count = std::min(kBlock, eighth - x);
    for (int y = 0; y < rows.height(); ++y) {
      double* of_row = moments + static_cast<std::ptrdiff_t>(y) * 3 * table.count();
      fold(rows.pixel(x, y), rows.row(y) + 3 * (quarter - x), quarter, count, table.degree() > 0, folded);
      Turned constant;
      add(folded.all, table.cosines(0) + x, table.sines(0) + x, count, constant);
      for (int c = 0; c < 3; ++c) of_row[c] += constant.cosine[c];
      for (int m = 1; m <= table.degree(); ++m) {
        double* moment = of_row + 3 * (2 * m - 1);
        const double *cosine = table.cosines(m) + x, *sine = table.sines(m) + x;
        Turned first, behind;
        if (m % 2 == 0) {
          add(m % 4 == 0 ? folded.all : folded.alternating, cosine, sine, count, first);
        } else {
          add(folded.across, cosine, sine, count, first);
          add(folded.aside, cosine, sine, count, behind);
          turn(behind, m * (kMiddle - kPi / 2), moment);
        }
        turn(first, m * kMiddle, moment);
      }
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
