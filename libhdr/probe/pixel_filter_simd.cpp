// filter_row and place_tile on vectors: a row of a kernel is weighed eight pixels at a time, and each pixel's three
// channels (and the float after them, which is dropped) are summed as one vector of four, in the same order everywhere.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libhdr/probe/internal/kernel.h"
#include "libhdr/probe/internal/pixel_filter.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/probe/pixel_filter_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, 8>;
using VF = hn::Vec<F>;
constexpr F f;

/// Products are rounded before they are added to: fused ones would give each target its own bytes.
HWY_INLINE VF mul_add(VF a, VF b, VF c) {
  return hn::Add(hn::Mul(a, b), c);
}

/// A pixel's three channels and the float after them.
#if HWY_TARGET == HWY_SCALAR
struct Four {
  float v[4] = {0, 0, 0, 0};
  HWY_INLINE void add(float w, const float* pixel) {
    for (int c = 0; c < 4; ++c) v[c] += w * pixel[c];
  }
  HWY_INLINE void add(float w, const Four& a, const Four& b) {
    for (int c = 0; c < 4; ++c) v[c] += w * (a.v[c] + b.v[c]);
  }
  HWY_INLINE void store(float scale, float floor, float* to) const {
    for (int c = 0; c < 4; ++c) to[c] = std::max(v[c] * scale, floor);
  }
};
#else
struct Four {
  static constexpr hn::FixedTag<float, 4> tag{};
  hn::Vec<hn::FixedTag<float, 4> > v;
  HWY_INLINE Four() : v(hn::Zero(tag)) {}  // an implicit one would not be compiled for the target
  HWY_INLINE void add(float w, const float* pixel) { v = hn::Add(v, hn::Mul(hn::Set(tag, w), hn::LoadU(tag, pixel))); }
  HWY_INLINE void add(float w, hn::Vec<hn::FixedTag<float, 4> > a) { v = hn::Add(v, hn::Mul(hn::Set(tag, w), a)); }
  HWY_INLINE void add(float w, const Four& a, const Four& b) {
    v = hn::Add(v, hn::Mul(hn::Set(tag, w), hn::Add(a.v, b.v)));
  }
  HWY_INLINE void store(float scale, float floor, float* to) const {
    hn::StoreU(hn::Max(hn::Mul(v, hn::Set(tag, scale)), hn::Set(tag, floor)), tag, to);
  }
};
#endif

/// SharpKernel::at, the three cubics of u = t, t - 1, t - 2.
HWY_INLINE VF sharp_weight(VF t) {
  constexpr float n = SharpKernel::kNear, k = SharpKernel::kFar;
  t = hn::Abs(t);
  const VF one = hn::Set(f, 1.0f), two = hn::Set(f, 2.0f);
  const auto near = hn::Lt(t, one), middle = hn::Lt(t, two);
  const VF u = hn::Sub(t, hn::IfThenElse(near, hn::Zero(f), hn::IfThenElse(middle, one, two)));
  const auto pick = [&](float a, float b, float c) HWY_ATTR {
    return hn::IfThenElse(near, hn::Set(f, a), hn::IfThenElse(middle, hn::Set(f, b), hn::Set(f, c)));
  };
  const VF c3 = pick(2 + n, n + k, k), c2 = pick(-(3 + n), -(2 * n + k), -2 * k), c1 = pick(0, n, k);
  const VF value = mul_add(mul_add(mul_add(c3, u, c2), u, c1), u, hn::IfThenElseZero(near, one));
  return hn::IfThenElseZero(hn::Lt(t, hn::Set(f, 3.0f)), value);
}

HWY_INLINE VF tent_weight(VF t) {
  return hn::Max(hn::Zero(f), hn::Sub(hn::Set(f, 1.0f), hn::Abs(t)));
}

template <class Kernel>
HWY_INLINE VF weight(VF t) {
  if constexpr (Kernel::kReach == SharpKernel::kReach) {
    return sharp_weight(t);
  } else {
    return tent_weight(t);
  }
}

/// Sums over a kernel, eight pixels at a time: of each of their 24 floats and of their weights, added up at the end, in
/// one order whatever the number of lanes.
template <class Kernel>
class KernelSums {
 public:
  static constexpr int kPixels = 8;

  HWY_INLINE KernelSums() {
    for (VF& sum : rgb_) sum = hn::Zero(f);
    for (VF& sum : weights_) sum = hn::Zero(f);
    for (int j = 0; j < 3; ++j) {
      alignas(32) std::int32_t pixel[kLanes];
      for (int k = 0; k < kLanes; ++k) pixel[k] = (j * kLanes + k) / 3;
      std::copy_n(pixel, kLanes, spread_ + j * kLanes);
    }
  }

  /// Pixels i .. i + 7 of a row at `source`, of which those below `from` and above `last` do not count: what lies there
  /// is read, but may be anything. `middle` is where the kernel's middle crosses the row.
  template <bool kPart>
  HWY_INLINE void add(const float* source, int i, int from, int last, float middle, float per_pixel, float row_weight) {
    for (int g = 0; g < kGroups; ++g) {
      const VF px = hn::Add(hn::Set(f, static_cast<float>(i + g * kLanes)), hn::Iota(f, 0));
      VF w = weight<Kernel>(hn::Mul(hn::Sub(px, hn::Set(f, middle)), hn::Set(f, per_pixel)));
      w = hn::Mul(w, hn::Set(f, row_weight));
      if constexpr (kPart) {
        const auto counts =
            hn::And(hn::Ge(px, hn::Set(f, static_cast<float>(from))), hn::Le(px, hn::Set(f, static_cast<float>(last))));
        w = hn::IfThenElseZero(counts, w);
      }
      weights_[g] = hn::Add(weights_[g], w);
      const float* p = source + 3 * (static_cast<std::ptrdiff_t>(i) + g * kLanes);
      for (int j = 0; j < 3; ++j) {
        const VF spread = hn::TableLookupLanes(w, hn::SetTableIndices(f, spread_ + j * kLanes));
        VF product = hn::Mul(spread, hn::LoadU(f, p + j * kLanes));
        if constexpr (kPart) product = hn::IfThenElseZero(hn::Ne(spread, hn::Zero(f)), product);
        rgb_[3 * g + j] = hn::Add(rgb_[3 * g + j], product);
      }
    }
  }

  HWY_INLINE void write(float floor, float* rgb) const {
    alignas(32) float floats[3 * kPixels], weights[kPixels];
    for (int k = 0; k < 3 * kGroups; ++k) hn::Store(rgb_[k], f, floats + k * kLanes);
    for (int k = 0; k < kGroups; ++k) hn::Store(weights_[k], f, weights + k * kLanes);
    float total = 0;
    for (const float w : weights) total += w;
    for (int c = 0; c < 3; ++c) {
      float sum = 0;
      for (int k = 0; k < kPixels; ++k) sum += floats[3 * k + c];
      rgb[c] = std::max(sum / total, floor);
    }
  }

 private:
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(f)), kGroups = kPixels / kLanes;
  VF rgb_[3 * kGroups], weights_[kGroups];
  alignas(32) std::int32_t spread_[3 * kLanes];  ///< which pixel's each float of three vectors is
};

template <class Kernel>
HWY_INLINE void filter_pixel(const RowTask& task, int index, float* rgb) {
  constexpr int kPixels = KernelSums<Kernel>::kPixels;
  const TilePixels& p = *task.pixels;
  const float x = p.x[index], y = p.y[index], across = p.across[index], down = p.down[index], shear = p.shear[index];
  const float half_height = Kernel::kReach * down, half_width = Kernel::kReach * across;
  const int first_row = static_cast<int>(std::ceil(y - half_height));
  const int last_row = static_cast<int>(std::floor(y + half_height));
  KernelSums<Kernel> sums;
  for (int j = first_row; j <= last_row; ++j) {
    const float dy = static_cast<float>(j) - y, middle = x + shear * dy;
    const auto row_weight = static_cast<float>(Kernel::at(dy / down));
    const int first = static_cast<int>(std::ceil(middle - half_width));
    const int last = static_cast<int>(std::floor(middle + half_width));
    const float* row = task.source + j * task.stride;
    int i = first;
    for (; i + kPixels - 1 <= last; i += kPixels) {
      sums.template add<false>(row, i, first, last, middle, 1 / across, row_weight);
    }
    if (i > last) continue;
    // The last pixels of the row again, or what lies beside a short one.
    const int start = std::clamp(last - kPixels + 1, 0, task.width - kPixels);
    sums.template add<true>(row, start, i, last, middle, 1 / across, row_weight);
  }
  sums.write(task.floor, rgb);
}

/// The eight weights of a position between samples: lane k is the sample k - 3 away. Each is a polynomial of the
/// fraction, through Chebyshev's points: within 1e-6 of the window.
struct EightWeights {
  static constexpr int kTerms = 8;
  alignas(32) float c[kTerms][8];
  EightWeights() {
    double nodes[kTerms], values[kTerms][8];
    for (int i = 0; i < kTerms; ++i) {
      nodes[i] = 0.5 - 0.5 * std::cos(std::numbers::pi * (i + 0.5) / kTerms);
      double sum = 0;
      for (int k = 0; k < 8; ++k) sum += values[i][k] = InterpolatingKernel::at(nodes[i] - (k - 3));
      for (int k = 0; k < 8; ++k) values[i][k] /= sum;
    }
    for (int k = 0; k < 8; ++k) {
      // Newton's divided differences, then his form multiplied out.
      double d[kTerms], power[kTerms] = {};
      for (int i = 0; i < kTerms; ++i) d[i] = values[i][k];
      for (int order = 1; order < kTerms; ++order) {
        for (int i = kTerms - 1; i >= order; --i) d[i] = (d[i] - d[i - 1]) / (nodes[i] - nodes[i - order]);
      }
      for (int i = kTerms - 1; i >= 0; --i) {
        for (int p = kTerms - 1; p > 0; --p) power[p] = power[p - 1] - nodes[i] * power[p];
        power[0] = d[i] - nodes[i] * power[0];
      }
      for (int p = 0; p < kTerms; ++p) c[p][k] = static_cast<float>(power[p]);
    }
  }
};

/// The weights at each lane of a fraction.
HWY_INLINE void eight_weights(const EightWeights& table, float fraction, float* weights) {
  const VF t = hn::Set(f, fraction);
  for (int k = 0; k < 8; k += static_cast<int>(hn::Lanes(f))) {
    VF value = hn::Load(f, table.c[EightWeights::kTerms - 1] + k);
    for (int p = EightWeights::kTerms - 2; p >= 0; --p) value = mul_add(value, t, hn::Load(f, table.c[p] + k));
    hn::Store(value, f, weights + k);
  }
}

/// Eight rows of the vector at p, weighed.
HWY_INLINE VF eight_rows(const float* p, std::ptrdiff_t stride, const float* down) {
  VF even = hn::Mul(hn::Set(f, down[0]), hn::LoadU(f, p));
  VF odd = hn::Mul(hn::Set(f, down[1]), hn::LoadU(f, p + stride));
  for (int j = 2; j < 8; j += 2) {
    even = mul_add(hn::Set(f, down[j]), hn::LoadU(f, p + j * stride), even);
    odd = mul_add(hn::Set(f, down[j + 1]), hn::LoadU(f, p + (j + 1) * stride), odd);
  }
  return hn::Add(even, odd);
}

/// Eight pixels of three channels, weighed.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Four eight_columns(const float* p, std::ptrdiff_t stride, const float* across, const float* down) {
  float row[25];
  for (int k = 0; k < 24; ++k) row[k] = eight_rows(p + k, stride, down).raw;
  row[24] = 0;  // what the last pixel's fourth float is
  Four even, odd, total;
  for (int k = 0; k < 8; k += 2) {
    even.add(across[k], row + 3 * k);
    odd.add(across[k + 1], row + 3 * k + 3);
  }
  total.add(1, even, odd);
  return total;
}
#else
/// Out of registers: through memory, loads would begin between what was stored.
HWY_INLINE Four eight_columns(const float* p, std::ptrdiff_t stride, const float* across, const float* down) {
  constexpr auto four = Four::tag;
  hn::Vec<hn::FixedTag<float, 4> > v[6];
#if HWY_TARGET <= HWY_AVX2
  for (int k = 0; k < 3; ++k) {
    const VF both = eight_rows(p + 8 * k, stride, down);
    v[2 * k] = hn::LowerHalf(four, both);
    v[2 * k + 1] = hn::UpperHalf(four, both);
  }
#else
  for (int k = 0; k < 6; ++k) v[k] = eight_rows(p + 4 * k, stride, down);
#endif
  Four even, odd, total;
  even.add(across[0], v[0]);
  odd.add(across[1], hn::CombineShiftRightBytes<12>(four, v[1], v[0]));
  even.add(across[2], hn::CombineShiftRightBytes<8>(four, v[2], v[1]));
  odd.add(across[3], hn::CombineShiftRightBytes<4>(four, v[3], v[2]));
  even.add(across[4], v[3]);
  odd.add(across[5], hn::CombineShiftRightBytes<12>(four, v[4], v[3]));
  even.add(across[6], hn::CombineShiftRightBytes<8>(four, v[5], v[4]));
  odd.add(across[7], hn::CombineShiftRightBytes<4>(four, v[5], v[5]));
  total.add(1, even, odd);
  return total;
}
#endif

/// Down first: eight rows of eight pixels become one.
HWY_INLINE void interpolate_pixel(const RowTask& task, const EightWeights& table, int index, float* rgb) {
  const float x = task.pixels->x[index], y = task.pixels->y[index];
  const float left = std::floor(x), top = std::floor(y);
  alignas(32) float across[8], down[8];
  eight_weights(table, x - left, across);
  eight_weights(table, y - top, down);
  const float* source =
      task.source + (static_cast<std::ptrdiff_t>(top) - 3) * task.stride + 3 * (static_cast<std::ptrdiff_t>(left) - 3);
  float values[4];
  eight_columns(source, task.stride, across, down).store(1, task.floor, values);
  rgb[0] = values[0];
  rgb[1] = values[1];
  rgb[2] = values[2];
}

/// A run of positions among a spline's coefficients: the first of each one's four by four, and the weights of rows and
/// columns [Unser93].
struct SplineRun {
  static constexpr int kMost = 8;
  alignas(32) float left[kMost], top[kMost], across[4][kMost], down[4][kMost];
};

HWY_INLINE void spline_weights(VF t, float (*weights)[SplineRun::kMost], int lane) {
  const VF u = hn::Sub(hn::Set(f, 1.0f), t), t2 = hn::Mul(t, t), u2 = hn::Mul(u, u);
  const VF sixth = hn::Set(f, 1.0f / 6), half = hn::Set(f, 0.5f), two_thirds = hn::Set(f, 2.0f / 3);
  const VF t3 = hn::Mul(t2, t), u3 = hn::Mul(u2, u);
  hn::Store(hn::Mul(u3, sixth), f, weights[0] + lane);
  hn::Store(mul_add(half, t3, hn::Sub(two_thirds, t2)), f, weights[1] + lane);
  hn::Store(mul_add(half, u3, hn::Sub(two_thirds, u2)), f, weights[2] + lane);
  hn::Store(hn::Mul(t3, sixth), f, weights[3] + lane);
}

HWY_INLINE void place_run(const TilePixels& pixels, int index, SplineRun& run) {
  for (int k = 0; k < SplineRun::kMost; k += static_cast<int>(hn::Lanes(f))) {
    const VF x = hn::LoadU(f, pixels.x + index + k), y = hn::LoadU(f, pixels.y + index + k);
    const VF left = hn::Floor(x), top = hn::Floor(y);
    hn::Store(left, f, run.left + k);
    hn::Store(top, f, run.top + k);
    spline_weights(hn::Sub(x, left), run.across, k);
    spline_weights(hn::Sub(y, top), run.down, k);
  }
}

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Four spline_sum(const SplineRun& run, int k, const float* p, std::ptrdiff_t stride) {
  Four columns[4], total;
  for (int j = 0; j < 4; ++j, p += stride) {
    for (int i = 0; i < 4; ++i) columns[i].add(run.down[j][k], p + 3 * i);
  }
  for (int i = 0; i < 4; ++i) total.add(run.across[i][k], columns[i].v);
  return total;
}
#else
/// Down first: four rows of four pixels become one of three vectors, out of which each pixel's is shifted.
HWY_INLINE Four spline_sum(const SplineRun& run, int k, const float* p, std::ptrdiff_t stride) {
  constexpr auto four = Four::tag;
#if HWY_TARGET <= HWY_AVX2  // the first two as one
  const auto both_of = [](float weight, const float* at)
                           HWY_ATTR { return hn::Mul(hn::Set(f, weight), hn::LoadU(f, at)); };
  VF both = both_of(run.down[0][k], p);
  Four last, total;
  last.v = hn::Mul(hn::Set(four, run.down[0][k]), hn::LoadU(four, p + 8));
  for (int j = 1; j < 4; ++j) {
    p += stride;
    both = hn::Add(both, both_of(run.down[j][k], p));
    last.add(run.down[j][k], p + 8);
  }
  const auto a = hn::LowerHalf(four, both), b = hn::UpperHalf(four, both), c = last.v;
  total.v = hn::Mul(hn::Set(four, run.across[0][k]), a);
#else
  Four in_a, in_b, in_c, total;
  for (int j = 0; j < 4; ++j, p += stride) {
    in_a.add(run.down[j][k], p);
    in_b.add(run.down[j][k], p + 4);
    in_c.add(run.down[j][k], p + 8);
  }
  const auto a = in_a.v, b = in_b.v, c = in_c.v;
  total.add(run.across[0][k], a);
#endif
  total.add(run.across[1][k], hn::CombineShiftRightBytes<12>(four, b, a));
  total.add(run.across[2][k], hn::CombineShiftRightBytes<8>(four, c, b));
  total.add(run.across[3][k], hn::CombineShiftRightBytes<4>(four, c, c));
  return total;
}
#endif

HWY_INLINE void spline_run(const RowTask& task, int index, int count, float* rgb) {
  SplineRun run;
  place_run(*task.pixels, index, run);
  const SplineTile& spline = *task.spline;
  for (int k = 0; k < count; ++k, rgb += 3) {
    const float* p = spline.at(static_cast<int>(run.left[k]) - 1, static_cast<int>(run.top[k]) - 1);
    const Four sum = spline_sum(run, k, p, spline.stride());
    if (k + 1 < count) {  // the next pixel overwrites the fourth
      sum.store(1, task.floor, rgb);
      continue;
    }
    float values[4];
    sum.store(1, task.floor, values);
    rgb[0] = values[0];
    rgb[1] = values[1];
    rgb[2] = values[2];
  }
}

void FilterRow(const RowTask& task, float* rgb) {
  static const EightWeights table;
  for (int k = 0; k < task.count; ++k) {
    const int index = task.first + k;
    if (task.kinds[index] == KernelKind::kSpline) {
      int count = 1;
      while (count < SplineRun::kMost && k + count < task.count && task.kinds[index + count] == KernelKind::kSpline) {
        ++count;
      }
      spline_run(task, index, count, rgb + 3 * k);
      k += count - 1;
      continue;
    }
    if (task.kinds[index] == KernelKind::kInterpolated) interpolate_pixel(task, table, index, rgb + 3 * k);
    if (task.kinds[index] == KernelKind::kSharp) filter_pixel<SharpKernel>(task, index, rgb + 3 * k);
    if (task.kinds[index] == KernelKind::kTent) filter_pixel<TentKernel>(task, index, rgb + 3 * k);
  }
}

/// A cubic, and its derivative, of each lane.
struct Cubic {
  float c[4];
  HWY_INLINE VF at(VF s) const {
    return mul_add(mul_add(mul_add(hn::Set(f, c[3]), s, hn::Set(f, c[2])), s, hn::Set(f, c[1])), s, hn::Set(f, c[0]));
  }
  HWY_INLINE VF slope(VF s) const {
    return mul_add(mul_add(hn::Set(f, 3 * c[3]), s, hn::Set(f, 2 * c[2])), s, hn::Set(f, c[1]));
  }
};

/// The cubic in s of a bicubic at this t, and that of its derivative by t.
void at_row(const std::array<std::array<float, 4>, 4>& bicubic, float t, Cubic& row, Cubic& slope) {
  for (std::size_t i = 0; i < 4; ++i) {
    row.c[i] = bicubic[0][i] + t * (bicubic[1][i] + t * (bicubic[2][i] + t * bicubic[3][i]));
    slope.c[i] = bicubic[1][i] + t * (2 * bicubic[2][i] + t * 3 * bicubic[3][i]);
  }
}

TileBounds PlaceTile(const TilePolynomial& polynomial, const Tile& tile, TilePixels& pixels) {
  const float s_step = 2.0f / static_cast<float>(tile.width), t_step = 2.0f / static_cast<float>(tile.height);
  const float base_x = static_cast<float>(polynomial.base_x) - 0.5f,
              base_y = static_cast<float>(polynomial.base_y) - 0.5f;
  const VF half = hn::Set(f, 0.5f), one = hn::Set(f, 1.0f), zero = hn::Zero(f);
  VF x0 = hn::Set(f, 1e9f), y0 = x0, x1 = hn::Set(f, -1e9f), y1 = x1, scale = zero;
  for (int row = 0; row < tile.height; ++row) {
    Cubic x, x_t, y, y_t;
    const float t = (static_cast<float>(row) + 0.5f) * t_step - 1;
    at_row(polynomial.x, t, x, x_t);
    at_row(polynomial.y, t, y, y_t);
    for (int k = 0; k < tile.width; k += static_cast<int>(hn::Lanes(f))) {
      const VF s = hn::Sub(hn::Mul(hn::Add(hn::Iota(f, static_cast<float>(k)), half), hn::Set(f, s_step)), one);
      const VF x_u = hn::Mul(x.slope(s), hn::Set(f, s_step)), x_v = hn::Mul(x_t.at(s), hn::Set(f, t_step));
      const VF y_u = hn::Mul(y.slope(s), hn::Set(f, s_step)), y_v = hn::Mul(y_t.at(s), hn::Set(f, t_step));
      // kernel_shape(), all of its cases at once.
      VF a = hn::Add(hn::Mul(x_u, x_u), hn::Mul(x_v, x_v)), b = hn::Add(hn::Mul(x_u, y_u), hn::Mul(x_v, y_v));
      VF c = hn::Add(hn::Mul(y_u, y_u), hn::Mul(y_v, y_v));
      const VF mean = hn::Mul(half, hn::Add(a, c)), half_difference = hn::Mul(half, hn::Sub(a, c));
      const VF spread = hn::Sqrt(hn::Add(hn::Mul(half_difference, half_difference), hn::Mul(b, b)));
      const VF largest = hn::Add(mean, spread), least = hn::Sub(mean, spread);
      const auto small = hn::Lt(least, one);
      const VF stretch = hn::Div(hn::Sub(largest, one), hn::Max(hn::Add(spread, spread), hn::Set(f, 1e-20f)));
      a = hn::IfThenElse(small, mul_add(stretch, hn::Sub(a, least), one), a);
      b = hn::IfThenElse(small, hn::Mul(stretch, b), b);
      c = hn::IfThenElse(small, mul_add(stretch, hn::Sub(c, least), one), c);
      const auto copied = hn::Le(largest, one);
      a = hn::IfThenElse(copied, one, a);
      b = hn::IfThenElse(copied, zero, b);
      c = hn::IfThenElse(copied, one, c);
      const VF shear = hn::Div(b, c);
      const int index = row * Tile::kSide + k;
      const VF px = hn::Add(x.at(s), hn::Set(f, base_x)), py = hn::Add(y.at(s), hn::Set(f, base_y));
      const VF axis = hn::Sqrt(largest);
      // Lanes beyond the tile's width follow the polynomial on, and make the bounds a little wider.
      x0 = hn::Min(x0, px);
      x1 = hn::Max(x1, px);
      y0 = hn::Min(y0, py);
      y1 = hn::Max(y1, py);
      scale = hn::Max(scale, axis);
      hn::StoreU(px, f, pixels.x + index);
      hn::StoreU(py, f, pixels.y + index);
      hn::StoreU(axis, f, pixels.scale + index);
      hn::StoreU(hn::Sqrt(hn::Max(hn::Sub(a, hn::Mul(b, shear)), hn::Set(f, 1e-12f))), f, pixels.across + index);
      hn::StoreU(hn::Sqrt(c), f, pixels.down + index);
      hn::StoreU(shear, f, pixels.shear + index);
    }
  }
  const auto least = [](VF v) HWY_ATTR { return hn::GetLane(hn::MinOfLanes(f, v)); };
  const auto most = [](VF v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(f, v)); };
  return {least(x0), least(y0), most(x1), most(y1), most(scale)};
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr::internal {

HWY_EXPORT(FilterRow);
HWY_EXPORT(PlaceTile);

void filter_row(const RowTask& task, float* rgb) {
  HWY_DYNAMIC_DISPATCH(FilterRow)(task, rgb);
}

TileBounds place_tile(const TilePolynomial& polynomial, const Tile& tile, TilePixels& pixels) {
  return HWY_DYNAMIC_DISPATCH(PlaceTile)(polynomial, tile, pixels);
}

}  // namespace hdr::internal
#endif
