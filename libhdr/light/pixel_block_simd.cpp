// pixel_block.h on vectors, in double.
#include "libhdr/light/internal/pixel_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/light/pixel_block_simd.cpp"
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
constexpr double kRed = 0.2126, kGreen = 0.7152, kBlue = 0.0722;

HWY_INLINE void weigh(const float* block, double floor, double* weights) {
  const VD red = hn::Set(d64, kRed), green = hn::Set(d64, kGreen), blue = hn::Set(d64, kBlue);
  for (int x = 0; x < kPixelBlock; x += static_cast<int>(hn::Lanes(d64))) {
    hn::Vec<F> r, g, b;
    hn::LoadInterleaved3(f32, block + 3 * x, r, g, b);
    VD y = hn::Mul(hn::PromoteTo(d64, b), blue);
    y = hn::MulAdd(hn::PromoteTo(d64, g), green, y);
    y = hn::MulAdd(hn::PromoteTo(d64, r), red, y);
    hn::Store(hn::Max(hn::Zero(d64), hn::Sub(y, hn::Set(d64, floor))), d64, weights + x);
  }
}

// Four sums of four first, then four pixels: a quarter of the additions that wait for each other, and no branch to
// guess wrong, so that a processor goes on to the next draw while it waits for the pixels of this one.
HWY_INLINE PixelPlace find(const float* block, double floor, double wanted, bool wanted_is_share) {
  HWY_ALIGN double w[kPixelBlock];
  weigh(block, floor, w);
  double begins[4], sum = 0;
  for (int g = 0; g < 4; ++g) {
    begins[g] = sum;
    sum += (w[4 * g] + w[4 * g + 1]) + (w[4 * g + 2] + w[4 * g + 3]);
  }
  if (wanted_is_share) wanted *= sum;
  const int group = (begins[1] <= wanted) + (begins[2] <= wanted) + (begins[3] <= wanted);
  const double* four = w + 4 * group;
  double ends[4];
  double end = begins[group];
  for (int k = 0; k < 4; ++k) ends[k] = end += four[k];
  const int k = (ends[0] <= wanted) + (ends[1] <= wanted) + (ends[2] <= wanted);
  int index = 4 * group + k;
  if (ends[k] <= wanted || !(w[index] > 0)) {  // rounding: the last before it that has weight
    while (index > 0 && !(w[index] > 0)) --index;
    while (index < kPixelBlock - 1 && !(w[index] > 0)) ++index;
    return {index, kBelowOne, w[index]};
  }
  const double begin = k == 0 ? begins[group] : ends[k - 1];
  return {index, std::clamp((wanted - begin) / w[index], 0.0, kBelowOne), w[index]};
}

PixelPlace PlaceInBlock(const float* block, double floor, double wanted) {
  return find(block, floor, wanted, false);
}

PixelPlace PlaceOfShare(const float* block, double floor, double share) {
  return find(block, floor, share, true);
}

// Red, green, blue, red ... lie as they are in three vectors after one another; only sums are taken apart.
HWY_INLINE Rgb sum_whole_blocks(const float* row, int count, double* blocks) {
  constexpr int kPattern = 24;
  HWY_ALIGN double colours[kPattern], sums[kPattern];
  for (int k = 0; k < kPattern; ++k) colours[k] = k % 3 == 0 ? kRed : k % 3 == 1 ? kGreen : kBlue;
  const auto lanes = static_cast<int>(hn::Lanes(d64));
  VD colour[3], of_row[3];
  for (int v = 0; v < 3; ++v) {
    colour[v] = hn::Load(d64, colours + v * lanes);
    of_row[v] = hn::Zero(d64);
  }
  for (int block = 0; block < count; ++block) {
    VD sum[3] = {hn::Zero(d64), hn::Zero(d64), hn::Zero(d64)};
    for (int k = 0; k < 3 * kPixelBlock; k += 3 * lanes)
      for (int v = 0; v < 3; ++v)
        sum[v] = hn::Add(sum[v], hn::PromoteTo(d64, hn::LoadU(f32, row + 3 * kPixelBlock * block + k + v * lanes)));
    VD weight = hn::Mul(sum[0], colour[0]);
    weight = hn::MulAdd(sum[1], colour[1], weight);
    weight = hn::MulAdd(sum[2], colour[2], weight);
    blocks[block] = hn::GetLane(hn::SumOfLanes(d64, weight));
    for (int v = 0; v < 3; ++v) of_row[v] = hn::Add(of_row[v], sum[v]);
  }
  for (int v = 0; v < 3; ++v) hn::Store(of_row[v], d64, sums + v * lanes);
  Rgb total = Rgb::Zero();
  for (int k = 0; k < 3 * lanes; ++k) total[k % 3] += sums[k];
  return total;
}

Rgb SumBlocks(const float* row, int width, double floor, double* blocks) {
  const int whole = width / kPixelBlock;
  const Rgb total = sum_whole_blocks(row, whole, blocks);
  if (floor > 0) {
    for (int block = 0; block < whole; ++block) {
      HWY_ALIGN double w[kPixelBlock];
      weigh(row + 3 * kPixelBlock * block, floor, w);
      blocks[block] = 0;
      for (const double weight : w) blocks[block] += weight;
    }
  }
  if (width % kPixelBlock == 0) return total;
  return total + reference::sum_blocks(row + 3 * kPixelBlock * whole, width % kPixelBlock, floor, blocks + whole);
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr {
namespace internal {
HWY_EXPORT(PlaceInBlock);
HWY_EXPORT(PlaceOfShare);
HWY_EXPORT(SumBlocks);
}  // namespace internal

Rgb sum_blocks(const float* row, int width, double floor, double* blocks) {
  return HWY_DYNAMIC_DISPATCH(internal::SumBlocks)(row, width, floor, blocks);
}

PixelPlace place_in_block(const float* block, int pixels, double floor, double wanted) {
  if (pixels < kPixelBlock) return reference::place_in_block(block, pixels, floor, wanted);
  return HWY_DYNAMIC_DISPATCH(internal::PlaceInBlock)(block, floor, wanted);
}

PixelPlace place_of_share(const float* block, int pixels, double floor, double share) {
  if (pixels == kPixelBlock) return HWY_DYNAMIC_DISPATCH(internal::PlaceOfShare)(block, floor, share);
  double weight = 0;
  for (int k = 0; k < pixels; ++k) weight += pixel_weight(block + 3 * k, floor);
  return reference::place_in_block(block, pixels, floor, share * weight);
}

}  // namespace hdr
#endif
