#include <algorithm>

#include "libhdr/probe/internal/brightest.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/probe/brightest_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Of whole vectors; returns how many pixels that were.
int BrightestOfThree(const float* rgb, int count, float* value, float* least_sample) {
  constexpr hn::CappedTag<float, 8> f;
  const int lanes = static_cast<int>(hn::Lanes(f));
  auto least = hn::Zero(f);
  int k = 0;
  for (; k + lanes <= count; k += lanes) {
    hn::Vec<decltype(f)> r, g, b;
    hn::LoadInterleaved3(f, rgb + 3 * k, r, g, b);
    hn::StoreU(hn::Max(hn::Max(r, g), b), f, value + k);
    least = hn::Min(least, hn::Min(hn::Min(r, g), b));
  }
  *least_sample = hn::GetLane(hn::MinOfLanes(f, least));
  return k;
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr::internal {

HWY_EXPORT(BrightestOfThree);

float brightest_channels(const float* pixels, int channels, int count, float* value) {
  int k = 0;
  float least = 0;
  if (channels == 3) k = HWY_DYNAMIC_DISPATCH(BrightestOfThree)(pixels, count, value, &least);
  for (; k < count; ++k) {
    const float* p = pixels + k * channels;
    value[k] = *std::max_element(p, p + channels);
    least = std::min(least, *std::min_element(p, p + channels));
  }
  return least;
}

}  // namespace hdr::internal
#endif
