// A tile of a row on vectors: codes in planes, so that a vector holds one channel and its constants are scalars.
// Compiled once a target, as Highway's -inl.h files are: the guard toggles.
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "libhdr/merge/internal/merge_row.h"

#if defined(HDR_MERGE_TILE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HDR_MERGE_TILE_INL_H_
#undef HDR_MERGE_TILE_INL_H_
#else
#define HDR_MERGE_TILE_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, kTile>;
using VF = hn::Vec<F>;
using MF = hn::Mask<F>;
using I = hn::RebindToSigned<F>;
using VI = hn::Vec<I>;
constexpr F f;
constexpr I i32;

/// Every multiplication is rounded before it is added to: fused ones would give each target its own bytes.
HWY_INLINE VF gather(const float* table, VI index) {
  return hn::GatherIndex(f, table, index);
}

HWY_INLINE MF zero_mask() {
  return hn::Lt(hn::Zero(f), hn::Zero(f));
}

HWY_INLINE VF precision_at(const ChannelModel& m, VF level) {
  const VI bits = hn::ShiftRight<PrecisionTable::kShift>(hn::BitCast(i32, level));
  const VI bin = hn::Sub(bits, hn::Set(i32, PrecisionTable::kFirst));
  return gather(m.precision.values.data(),
                hn::Min(hn::Max(bin, hn::Zero(i32)), hn::Set(i32, PrecisionTable::kBins - 1)));
}

HWY_INLINE VI censoring_bin(VF z) {
  const VF bin = hn::Mul(hn::Add(z, hn::Set(f, CensoringTable::kReach)), hn::Set(f, CensoringTable::kBinsPerDeviation));
  const VF last = hn::Set(f, static_cast<float>(CensoringTable::kBins - 1));
  return hn::ConvertTo(i32, hn::Min(hn::Max(bin, hn::Zero(f)), last));
}

/// One tile of a row: the codes of all shots in planes, and the light they stand for once it was looked up.
template <class Code>
class Tile {
 public:
  using C = hn::CappedTag<Code, kTile>;
  static constexpr C codes_tag{};

  Tile(const MergeRowTask& task, MergeRowScratch& scratch, int x)
      : task_(task), planes_(reinterpret_cast<Code*>(scratch.planes.data())), levels_(scratch.levels.data()), x_(x) {
    pixels_ = std::min(kTile, task.width - x);
    for (int j = 0; j < task.count; ++j) {
      if (task.shots[j].codes) split(static_cast<const Code*>(task.shots[j].codes) + 3 * x, j);
    }
  }

  int pixels() const { return pixels_; }
  const Code* plane(int shot, int channel) const { return planes_ + (3 * shot + channel) * kTile; }

  /// Levels of a shot in channel c: looked up, or resampled before.
  const float* levels(int shot) const { return levels_ + shot * kTile; }
  void look_up(int shot, int c) {
    const auto channel = static_cast<std::size_t>(c);
    float* out = levels_ + shot * kTile;
    if (const WarpedRow* warped = task_.shots[shot].warped) {
      std::copy_n(warped->level[channel].data() + x_, kTile, out);
    } else {
      const float* table = task_.model->channel[channel].level.data();
      const Code* codes = plane(shot, c);
      for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f)))
        hn::StoreU(gather(table, indices(codes + k)), f, out + k);
    }
  }

  static HWY_INLINE VI indices(const Code* codes) {
    return hn::PromoteTo(i32, hn::LoadU(hn::Rebind<Code, I>(), codes));
  }

  /// Is any code of the plane above `bound`?
  bool any_above(int shot, int channel, int bound) const {
    if (bound >= static_cast<int>(hwy::LimitsMax<Code>())) return false;
    const Code* codes = plane(shot, channel);
    const auto limit = hn::Set(codes_tag, static_cast<Code>(std::max(bound, 0)));
    if (bound < 0) return true;
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(codes_tag))) {
      if (!hn::AllFalse(codes_tag, hn::Gt(hn::LoadU(codes_tag, codes + k), limit))) return true;
    }
    return false;
  }
  bool any_at_most(int shot, int channel, int bound) const {
    if (bound < 0) return false;
    if (bound >= static_cast<int>(hwy::LimitsMax<Code>())) return true;
    const Code* codes = plane(shot, channel);
    const auto limit = hn::Set(codes_tag, static_cast<Code>(bound));
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(codes_tag))) {
      if (!hn::AllTrue(codes_tag, hn::Gt(hn::LoadU(codes_tag, codes + k), limit))) return true;
    }
    return false;
  }

 private:
  void split(const Code* codes, int shot) {
    // The last tile of a row is filled up with its last pixel, which decides nothing that the others do not.
    HWY_ALIGN Code padded[3 * kTile];
    if (pixels_ < kTile) {
      std::memcpy(padded, codes, 3 * static_cast<std::size_t>(pixels_) * sizeof(Code));
      for (int k = 3 * pixels_; k < 3 * kTile; ++k) padded[k] = padded[k - 3];
      codes = padded;
    }
    Code* out = planes_ + 3 * shot * kTile;
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(codes_tag))) {
      hn::Vec<C> r, g, b;
      hn::LoadInterleaved3(codes_tag, codes + 3 * k, r, g, b);
      hn::StoreU(r, codes_tag, out + k);
      hn::StoreU(g, codes_tag, out + kTile + k);
      hn::StoreU(b, codes_tag, out + 2 * kTile + k);
    }
  }

  const MergeRowTask& task_;
  Code* planes_;
  float* levels_;
  int x_, pixels_;
};

/// Results of one channel of a tile.
struct Plane {
  HWY_ALIGN float value[kTile];
  HWY_ALIGN float stddev[kTile];
  HWY_ALIGN float unmeasured[kTile];  ///< 1 or 0
};
}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
