#include "libhdr/probe/internal/whitened_squares.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/probe/whitened_squares_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Products are rounded before they are added to: fused ones would give each target its own bytes.
void WhitenedSquares(const float* w, int size, const float* profiles, std::ptrdiff_t stride, int count,
                     float* squares) {
  using F = hn::CappedTag<float, kWhitenedColumns>;
  constexpr F f;
  for (int k = 0; k < count; k += static_cast<int>(hn::Lanes(f))) {
    auto sum = hn::Zero(f);
    const float* row = w;
    for (int i = 0; i < size; ++i, row += size) {
      auto even = hn::Zero(f), odd = hn::Zero(f);  // two chains, so that neither waits for the other
      int j = 0;
      for (; j < i; j += 2) {
        even = hn::Add(even, hn::Mul(hn::Set(f, row[j]), hn::LoadU(f, profiles + j * stride + k)));
        odd = hn::Add(odd, hn::Mul(hn::Set(f, row[j + 1]), hn::LoadU(f, profiles + (j + 1) * stride + k)));
      }
      if (j == i) even = hn::Add(even, hn::Mul(hn::Set(f, row[j]), hn::LoadU(f, profiles + j * stride + k)));
      const auto value = hn::Add(even, odd);
      sum = hn::Add(sum, hn::Mul(value, value));
    }
    hn::StoreU(sum, f, squares + k);
  }
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr::internal {

HWY_EXPORT(WhitenedSquares);

void whitened_squares(const float* w, int size, const float* profiles, std::ptrdiff_t stride, int count,
                      float* squares) {
  HWY_DYNAMIC_DISPATCH(WhitenedSquares)(w, size, profiles, stride, count, squares);
}

}  // namespace hdr::internal
#endif
