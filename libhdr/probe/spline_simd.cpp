// The two filters of a spline's coefficients and the check before them, on vectors of floats that need not know whose
// channel they are.
#include <algorithm>

#include "libhdr/probe/internal/spline.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/probe/spline_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// As wide as the target has them; narrow ones for boxes of few pixels.
using Wide = hn::CappedTag<float, 16>;
using Narrow = hn::CappedTag<float, 8>;

/// The seven samples around p, `step` floats apart, weighed; products are rounded before they are added to, so that
/// each target has the same bytes.
template <class F>
HWY_INLINE hn::Vec<F> filtered(F f, const float* p, std::ptrdiff_t step) {
  hn::Vec<F> sum = hn::Mul(hn::Set(f, SplineTile::kFilter[0]), hn::LoadU(f, p));
  for (int k = 1; k <= SplineTile::kFilterReach; ++k) {
    const auto pair = hn::Add(hn::LoadU(f, p - k * step), hn::LoadU(f, p + k * step));
    sum = hn::Add(sum, hn::Mul(hn::Set(f, SplineTile::kFilter[k]), pair));
  }
  return sum;
}

/// The vectors that cover `count` floats, of which the last may begin within the one before it.
template <class F, class Body>
HWY_INLINE void for_vectors(F f, int count, Body body) {
  const int lanes = static_cast<int>(hn::Lanes(f));
  for (int k = 0; k < count; k += lanes) body(std::min(k, count - lanes));
}

template <class F>
HWY_INLINE void filter_floats(F f, const float* from, std::ptrdiff_t step, int count, float* to) {
  for_vectors(f, count, [&](int k) HWY_ATTR { hn::StoreU(filtered(f, from + k, step), f, to + k); });
}

/// Down into `row`, then across, a row of coefficients at a time.
template <class F>
HWY_INLINE void filter_box(F f, const float* source, std::ptrdiff_t stride, const PixelBox& box, float* row,
                           float* to) {
  const int count = 3 * (box.last_x - box.first_x), margin = 3 * SplineTile::kFilterReach;
  for (int y = box.first_y; y < box.last_y; ++y, to += count) {
    filter_floats(f, source + y * stride + 3 * static_cast<std::ptrdiff_t>(box.first_x) - margin, stride,
                  count + 2 * margin, row);
    filter_floats(f, row + margin, 3, count, to);
  }
}

template <class F>
HWY_INLINE hn::Vec<F> fourth_difference(F f, const float* p, std::ptrdiff_t step, hn::Vec<F> six_here) {
  const auto outer = hn::Add(hn::LoadU(f, p - 2 * step), hn::LoadU(f, p + 2 * step));
  const auto inner = hn::Add(hn::LoadU(f, p - step), hn::LoadU(f, p + step));
  return hn::Abs(hn::Add(hn::Sub(outer, hn::Mul(hn::Set(f, 4.0f), inner)), six_here));
}

template <class F>
HWY_INLINE bool below_everywhere(F f, const float* source, std::ptrdiff_t stride, const PixelBox& box, float limit) {
  const int count = 3 * (box.last_x - box.first_x);
  for (int y = box.first_y; y < box.last_y; ++y) {
    const float* row = source + y * stride + 3 * static_cast<std::ptrdiff_t>(box.first_x);
    hn::Vec<F> most = hn::Zero(f);
    for_vectors(f, count, [&](int k) HWY_ATTR {
      const auto six = hn::Mul(hn::Set(f, 6.0f), hn::LoadU(f, row + k));
      most = hn::Max(most, hn::Max(fourth_difference(f, row + k, 3, six), fourth_difference(f, row + k, stride, six)));
    });
    if (!hn::AllTrue(f, hn::Le(most, hn::Set(f, limit)))) return false;
  }
  return true;
}

bool is_wide(const PixelBox& box) {
  return 3 * (box.last_x - box.first_x) >= static_cast<int>(hn::Lanes(Wide()));
}

void FilterBox(const float* source, std::ptrdiff_t stride, const PixelBox& box, float* row, float* to) {
  if (is_wide(box)) return filter_box(Wide(), source, stride, box, row, to);
  filter_box(Narrow(), source, stride, box, row, to);
}

bool BelowEverywhere(const float* source, std::ptrdiff_t stride, const PixelBox& box, float limit) {
  if (is_wide(box)) return below_everywhere(Wide(), source, stride, box, limit);
  return below_everywhere(Narrow(), source, stride, box, limit);
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr::internal {
namespace {

HWY_EXPORT(FilterBox);
HWY_EXPORT(BelowEverywhere);

/// Of five by five pixels, in one order everywhere.
float mean_of(const float* source, std::ptrdiff_t stride, const PixelBox& box) {
  constexpr int kSteps = 4;
  float sum = 0;
  for (int j = 0; j <= kSteps; ++j) {
    const float* row = source + (box.first_y + (box.last_y - 1 - box.first_y) * j / kSteps) * stride;
    for (int i = 0; i <= kSteps; ++i) {
      const float* p = row + 3 * (box.first_x + (box.last_x - 1 - box.first_x) * i / kSteps);
      sum += p[0] + p[1] + p[2];
    }
  }
  return sum / (3 * (kSteps + 1) * (kSteps + 1));
}

}  // namespace

void SplineTile::fill(const float* source, std::ptrdiff_t stride, const PixelBox& box) {
  box_ = box;
  const int count = 3 * (box.last_x - box.first_x), margin = 3 * kFilterReach;
  stride_ = count;
  constexpr std::size_t kNextPixel = 3;
  coefficients_.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(box.last_y - box.first_y) +
                       kNextPixel);
  row_.resize(static_cast<std::size_t>(count + 2 * margin));
  HWY_DYNAMIC_DISPATCH(FilterBox)(source, stride, box, row_.data(), coefficients_.data());
}

bool fits_spline(const float* source, std::ptrdiff_t stride, const PixelBox& box) {
  constexpr float kMost = 1.0f / 3;
  const float mean = mean_of(source, stride, box);
  return mean >= 0 && HWY_DYNAMIC_DISPATCH(BelowEverywhere)(source, stride, box, kMost * mean);
}

}  // namespace hdr::internal
#endif
