// row_moments on vectors. The four pixels of a row that lie a quarter turn apart see the same |cos m phi|, |sin m phi|:
// they are added with their signs first (the first step of a fast Fourier transform), and a quarter of the products is
// left. With azimuths phi - k pi/2, k = 0..3, of pixels a, b, c, d:
//   m = 0, 4, 8 ...:  a + b + c + d           m = 2, 6 ...:  a - b + c - d
//   m odd, s = sin(m pi/2):  cosine moment (a - c) cos + s (b - d) sin,  sine moment (a - c) sin - s (b - d) cos
#include <algorithm>

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
constexpr int kBlock = 128;  // columns of a quarter: what is folded stays in the first cache

// Three channels of a block, folded.
struct Plane {
  HWY_ALIGN double c[3][kBlock];
};
struct Folded {
  Plane all, alternating, across, aside;
};

HWY_INLINE void load3(const float* p, VD& r, VD& g, VD& b) {
  hn::Vec<F> fr, fg, fb;
  hn::LoadInterleaved3(f32, p, fr, fg, fb);
  r = hn::PromoteTo(d64, fr);
  g = hn::PromoteTo(d64, fg);
  b = hn::PromoteTo(d64, fb);
}

HWY_INLINE void fold_channel(VD a, VD b, VD c, VD d, int channel, int x, Folded& out) {
  const VD ac = hn::Add(a, c), bd = hn::Add(b, d);
  hn::Store(hn::Add(ac, bd), d64, out.all.c[channel] + x);
  hn::Store(hn::Sub(ac, bd), d64, out.alternating.c[channel] + x);
  hn::Store(hn::Sub(a, c), d64, out.across.c[channel] + x);
  hn::Store(hn::Sub(b, d), d64, out.aside.c[channel] + x);
}

// `count` columns from p on; what is left of the last vector is filled with black.
HWY_INLINE void fold(const float* p, std::ptrdiff_t quarter, int count, Folded& out) {
  const int lanes = static_cast<int>(hn::Lanes(d64));
  for (int x = 0; x < count; x += lanes) {
    HWY_ALIGN float padded[4][3 * 8] = {};
    const float* from[4];
    for (int k = 0; k < 4; ++k) {
      from[k] = p + 3 * (x + k * quarter);
      if (x + lanes <= count) continue;
      std::copy_n(from[k], 3 * (count - x), padded[k]);
      from[k] = padded[k];
    }
    VD r[4], g[4], b[4];
    for (int k = 0; k < 4; ++k) load3(from[k], r[k], g[k], b[k]);
    fold_channel(r[0], r[1], r[2], r[3], 0, x, out);
    fold_channel(g[0], g[1], g[2], g[3], 1, x, out);
    fold_channel(b[0], b[1], b[2], b[3], 2, x, out);
  }
}

HWY_INLINE double total_of(VD v) {
  return hn::GetLane(hn::SumOfLanes(d64, v));
}

HWY_INLINE void add_constant(const Plane& plane, int count, double cell, double* moment) {
  for (int c = 0; c < 3; ++c) {
    VD sum = hn::Zero(d64);
    for (int x = 0; x < count; x += static_cast<int>(hn::Lanes(d64))) sum = hn::Add(sum, hn::Load(d64, plane.c[c] + x));
    moment[c] += cell * total_of(sum);
  }
}

HWY_INLINE void add_even(const Plane& plane, const double* cosine, const double* sine, int count, double* moment) {
  VD cos_sum[3] = {hn::Zero(d64), hn::Zero(d64), hn::Zero(d64)}, sin_sum[3] = {cos_sum[0], cos_sum[0], cos_sum[0]};
  for (int x = 0; x < count; x += static_cast<int>(hn::Lanes(d64))) {
    const VD cos_x = hn::LoadU(d64, cosine + x), sin_x = hn::LoadU(d64, sine + x);
    for (int c = 0; c < 3; ++c) {
      const VD value = hn::Load(d64, plane.c[c] + x);
      cos_sum[c] = hn::MulAdd(value, cos_x, cos_sum[c]);
      sin_sum[c] = hn::MulAdd(value, sin_x, sin_sum[c]);
    }
  }
  for (int c = 0; c < 3; ++c) {
    moment[c] += total_of(cos_sum[c]);
    moment[3 + c] += total_of(sin_sum[c]);
  }
}

HWY_INLINE void add_odd(const Folded& folded, const double* cosine, const double* sine, double sign, int count,
                        double* moment) {
  VD cos_sum[3] = {hn::Zero(d64), hn::Zero(d64), hn::Zero(d64)}, sin_sum[3] = {cos_sum[0], cos_sum[0], cos_sum[0]};
  const VD s = hn::Set(d64, sign);
  for (int x = 0; x < count; x += static_cast<int>(hn::Lanes(d64))) {
    const VD cos_x = hn::LoadU(d64, cosine + x), sin_x = hn::LoadU(d64, sine + x);
    const VD turned_cos = hn::Mul(s, sin_x), turned_sin = hn::Mul(s, cos_x);
    for (int c = 0; c < 3; ++c) {
      const VD across = hn::Load(d64, folded.across.c[c] + x), aside = hn::Load(d64, folded.aside.c[c] + x);
      cos_sum[c] = hn::MulAdd(aside, turned_cos, hn::MulAdd(across, cos_x, cos_sum[c]));
      sin_sum[c] = hn::NegMulAdd(aside, turned_sin, hn::MulAdd(across, sin_x, sin_sum[c]));
    }
  }
  for (int c = 0; c < 3; ++c) {
    moment[c] += total_of(cos_sum[c]);
    moment[3 + c] += total_of(sin_sum[c]);
  }
}

void RowMoments(View<const float> rows, const AzimuthTable& table, double* moments) {
  const int quarter = rows.width() / 4;
  Folded folded;
  std::fill_n(moments, static_cast<std::ptrdiff_t>(rows.height()) * 3 * table.count(), 0.0);
  for (int x = 0; x < quarter; x += kBlock) {
    const int count = std::min(kBlock, quarter - x);
    for (int y = 0; y < rows.height(); ++y) {
      double* of_row = moments + static_cast<std::ptrdiff_t>(y) * 3 * table.count();
      fold(rows.pixel(x, y), quarter, count, folded);
      add_constant(folded.all, count, table.cell(), of_row);
      for (int m = 1; m <= table.degree(); ++m) {
        double* moment = of_row + 3 * (2 * m - 1);
        const double *cosine = table.cosines(m) + x, *sine = table.sines(m) + x;
        if (m % 2 == 1) {
          add_odd(folded, cosine, sine, m % 4 == 1 ? 1.0 : -1.0, count, moment);
        } else {
          add_even(m % 4 == 0 ? folded.all : folded.alternating, cosine, sine, count, moment);
        }
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
