// merge_row on vectors: tile by tile, channel by channel; tiles in which a shot has nothing to add are passed over.
#include "libhdr/merge/internal/merge_row.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/merge/merge_row_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "libhdr/merge/internal/hat_tile-inl.h"
#include "libhdr/merge/internal/likelihood_tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {

HWY_INLINE void interleave(const float (&planes)[3][kTile], int pixels, float* out) {
  HWY_ALIGN float buffer[3 * kTile];
  float* target = pixels == kTile ? out : buffer;
  for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
    hn::StoreInterleaved3(hn::Load(f, planes[0] + k), hn::Load(f, planes[1] + k), hn::Load(f, planes[2] + k), f,
                          target + 3 * k);
  }
  if (target == buffer) std::memcpy(out, buffer, 3 * static_cast<std::size_t>(pixels) * sizeof(float));
}

template <class Code>
TileCount merge_row_of(const MergeRowTask& task, MergeRowScratch& scratch) {
  const auto tile_samples = static_cast<std::size_t>(task.count) * kTile;
  scratch.levels.resize(tile_samples);
  scratch.planes.resize(3 * tile_samples);
  TileCount count;
  for (int x = 0; x < task.width; x += kTile) {
    Tile<Code> tile(task, scratch, x);
    Plane planes[3];
    for (int c = 0; c < 3; ++c) {
      if (task.model->hat) {
        HatTile<Code> hat(task, tile, x, c, count);
        hat.merge(planes[c]);
        const TileCount counted = count;
        if (task.stddev) hat.stddev(planes[c]);
        count = counted;
      } else {
        LikelihoodTile<Code>(task, tile, x, c).merge(planes[c], count);
      }
    }
    HWY_ALIGN float out[3][kTile];
    for (int c = 0; c < 3; ++c) std::copy_n(planes[c].value, kTile, out[c]);
    interleave(out, tile.pixels(), task.rgb + 3 * x);
    if (task.stddev) {
      for (int c = 0; c < 3; ++c) std::copy_n(planes[c].stddev, kTile, out[c]);
      interleave(out, tile.pixels(), task.stddev + 3 * x);
    }
    for (int k = 0; k < tile.pixels(); ++k) {
      for (int c = 0; c < 3; ++c) task.unmeasured[3 * (x + k) + c] = planes[c].unmeasured[k] != 0;
    }
  }
  return count;
}

TileCount merge_row_on_target(const MergeRowTask& task, MergeRowScratch& scratch) {
  return task.model->bits <= 8 ? merge_row_of<std::uint8_t>(task, scratch) : merge_row_of<std::uint16_t>(task, scratch);
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr::internal {

HWY_EXPORT(merge_row_on_target);

WarpedRow::WarpedRow(int width) {
  const auto samples = static_cast<std::size_t>((width + kTile - 1) / kTile * kTile);
  for (std::size_t c = 0; c < 3; ++c) {
    level[c].assign(samples, -1.0f);
    weight[c].assign(samples, 0.0f);
    weight_light[c].assign(samples, 0.0f);
    information[c].assign(samples, 1.0f);
    trust[c].assign(samples, 1.0f);
    closes[c].assign(samples, 0);
  }
}

void WarpedRow::set_outside(std::size_t x) {
  for (std::size_t c = 0; c < 3; ++c) {
    level[c][x] = -1;
    weight[c][x] = weight_light[c][x] = 0;
    information[c][x] = trust[c][x] = 1;
    closes[c][x] = 0;
  }
}

TileCount merge_row(const MergeRowTask& task, MergeRowScratch& scratch) {
  return HWY_DYNAMIC_DISPATCH(merge_row_on_target)(task, scratch);
}

}  // namespace hdr::internal
#endif
