// merge_row on vectors. A tile's codes are split into planes, so that a vector holds one channel and its constants are
// scalars; tiles in which a shot has nothing to add are passed over.
#include <algorithm>
#include <cstring>

#include "libhdr/merge/internal/merge_row.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/merge/merge_row_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

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

// ---- the hat

template <class Code>
class HatTile {
 public:
  HatTile(const MergeRowTask& task, const Tile<Code>& tile, int x, int channel, TileCount& count)
      : task_(task),
        tile_(tile),
        x_(x),
        c_(channel),
        m_(task.model->channel[static_cast<std::size_t>(channel)]),
        count_(count) {}

  void merge(Plane& out) {
    std::fill_n(sum_, kTile, 0.0f);
    std::fill_n(total_, kTile, 0.0f);
    for_each_shot([&](int k, VF open, VF weight, VF weight_light, float exposure) HWY_ATTR {
      // Fused on some machines and not on others, and the same bits on all: times 0 or 1 nothing is rounded.
      hn::Store(hn::MulAdd(open, weight_light, hn::Load(f, sum_ + k)), f, sum_ + k);
      const VF part = hn::Mul(weight, hn::Set(f, exposure));
      hn::Store(hn::MulAdd(open, part, hn::Load(f, total_ + k)), f, total_ + k);
    });
    const VF least = hn::Set(f, std::numeric_limits<float>::min());
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
      const VF total = hn::Load(f, total_ + k);
      const MF measured = hn::Gt(total, hn::Zero(f));
      const VF value = hn::Div(hn::Load(f, sum_ + k), hn::IfThenElse(measured, total, least));
      hn::Store(hn::IfThenElseZero(measured, value), f, out.value + k);
      hn::Store(hn::IfThenElse(measured, hn::Zero(f), hn::Set(f, 1.0f)), f, out.unmeasured + k);
    }
  }

  void stddev(Plane& out) {
    std::fill_n(sum_, kTile, 0.0f);
    const VF per_saturation = hn::Set(f, 1 / m_.saturation);
    count_ = {};  // the same tiles once more: counted already
    for_each_shot([&](int k, VF open, VF weight, VF, float exposure) HWY_ATTR {
      const VF radiance = hn::Mul(hn::Load(f, out.value + k), per_saturation);
      const VF precision = precision_at(m_, hn::Mul(radiance, hn::Set(f, exposure)));
      const VF w = hn::Mul(open, weight);
      hn::Store(hn::Add(hn::Load(f, sum_ + k), hn::Div(hn::Mul(w, w), precision)), f, sum_ + k);
    });
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
      const VF total = hn::Load(f, total_ + k);
      const MF measured = hn::Gt(total, hn::Zero(f));
      const VF deviation = hn::Mul(hn::Set(f, m_.saturation), hn::Sqrt(hn::Load(f, sum_ + k)));
      const VF least = hn::Set(f, std::numeric_limits<float>::min());
      hn::Store(hn::IfThenElseZero(measured, hn::Div(deviation, hn::IfThenElse(measured, total, least))), f,
                out.stddev + k);
    }
  }

 private:
  /// add(k, open, weight, weight_light, exposure) for each vector of each shot that may have something to add.
  template <class Add>
  HWY_INLINE void for_each_shot(const Add& add) {
    std::fill_n(open_, kTile, 1.0f);
    bool all_closed = false;
    for (int j = 0; j < task_.count; ++j) {
      ++count_.all;
      const bool closable = task_.model->lossy;
      if (task_.skip_tiles && all_closed) {
        ++count_.skipped;
      } else if (task_.shots[j].warped) {
        add_warped(j, closable, add);
      } else if (task_.skip_tiles && !tile_.any_above(j, c_, m_.black_code)) {
        ++count_.skipped;  // all black
      } else if (task_.skip_tiles && !tile_.any_at_most(j, c_, task_.model->clipped_code - 1)) {
        ++count_.skipped;  // all clipped
        all_closed = closable;
      } else {
        add_codes(j, closable, add);
      }
    }
  }

  template <class Add>
  HWY_INLINE void add_codes(int j, bool closable, const Add& add) {
    const Code* codes = tile_.plane(j, c_);
    const VI closing = hn::Set(i32, task_.model->closing_code);
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
      const VI index = Tile<Code>::indices(codes + k);
      const VF open = hn::Load(f, open_ + k);
      add(k, open, gather(m_.weight.data(), index), gather(m_.weight_light.data(), index), task_.shots[j].exposure);
      if (!closable) continue;
      const MF closes = hn::RebindMask(f, hn::Gt(closing, index));
      hn::Store(hn::IfThenElseZero(closes, open), f, open_ + k);
    }
  }

  template <class Add>
  HWY_INLINE void add_warped(int j, bool closable, const Add& add) {
    const WarpedRow& row = *task_.shots[j].warped;
    const auto c = static_cast<std::size_t>(c_);
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
      add(k, hn::Load(f, open_ + k), hn::LoadU(f, row.weight[c].data() + x_ + k),
          hn::LoadU(f, row.weight_light[c].data() + x_ + k), task_.shots[j].exposure);
    }
    if (!closable) return;
    for (int k = 0; k < kTile; ++k) open_[k] = row.closes[c][static_cast<std::size_t>(x_ + k)] ? 0.0f : open_[k];
  }

  const MergeRowTask& task_;
  const Tile<Code>& tile_;
  int x_, c_;
  const ChannelModel& m_;
  TileCount& count_;
  HWY_ALIGN float sum_[kTile];
  HWY_ALIGN float total_[kTile];
  HWY_ALIGN float open_[kTile];
};

// ---- maximum likelihood

template <class Code>
class LikelihoodTile {
 public:
  LikelihoodTile(const MergeRowTask& task, Tile<Code>& tile, int x, int channel)
      : task_(task), tile_(tile), x_(x), c_(channel), m_(task.model->channel[static_cast<std::size_t>(channel)]) {
    looked_up_.assign(static_cast<std::size_t>(task.count), 0);
    if (!task.skip_tiles) {
      for (int j = 0; j < task.count; ++j) level_of(j);
    }
  }

  void merge(Plane& out, TileCount& count) {
    if (task_.model->lossy) find_closing_shots();
    first_guess();
    std::fill_n(chosen_, kTile, 1.0f);
    bool again = true;
    for (int step = 0; step < kSteps && again; ++step) again = score();
    const VF saturation = hn::Set(f, m_.saturation);
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
      const VF total = hn::Load(f, precision_ + k);
      const MF measured = hn::And(hn::Gt(total, hn::Zero(f)), hn::Gt(hn::Load(f, measured_ + k), hn::Zero(f)));
      hn::Store(hn::IfThenElseZero(measured, hn::Mul(hn::Load(f, radiance_ + k), saturation)), f, out.value + k);
      const VF root = hn::Sqrt(hn::IfThenElse(measured, total, hn::Set(f, 1.0f)));
      hn::Store(hn::IfThenElseZero(measured, hn::Div(saturation, root)), f, out.stddev + k);
      hn::Store(hn::IfThenElse(measured, hn::Zero(f), hn::Set(f, 1.0f)), f, out.unmeasured + k);
    }
    count.all += task_.count;
    count.skipped += std::count(looked_up_.begin(), looked_up_.end(), 0);
  }

 private:
  static constexpr int kSteps = 3;

  const float* level_of(int j) {
    if (!looked_up_[static_cast<std::size_t>(j)]) {
      tile_.look_up(j, c_);
      looked_up_[static_cast<std::size_t>(j)] = 1;
    }
    return tile_.levels(j);
  }

  /// Levels of shot j; negative outside the photograph and after a closing code.
  HWY_INLINE VF level_at(const float* levels, int j, int k) const {
    const VF level = hn::LoadU(f, levels + k);
    if (!task_.model->lossy) return level;
    const MF closed = hn::Lt(hn::Load(f, closing_shot_ + k), hn::Set(f, static_cast<float>(j)));
    return hn::IfThenElse(closed, hn::Set(f, -1.0f), level);
  }

  void find_closing_shots() {
    std::fill_n(closing_shot_, kTile, static_cast<float>(task_.count));
    const auto c = static_cast<std::size_t>(c_);
    for (int j = task_.count - 1; j >= 0; --j) {
      if (const WarpedRow* warped = task_.shots[j].warped) {
        for (int k = 0; k < kTile; ++k) {
          if (warped->closes[c][static_cast<std::size_t>(x_ + k)]) closing_shot_[k] = static_cast<float>(j);
        }
      } else if (tile_.any_above(j, c_, task_.model->closing_code - 1)) {
        const Code* codes = tile_.plane(j, c_);
        for (int k = 0; k < kTile; ++k) {
          if (codes[k] >= task_.model->closing_code) closing_shot_[k] = static_cast<float>(j);
        }
      }
    }
  }

  bool may_be_safe(int j) const {
    return task_.shots[j].warped || !task_.skip_tiles || tile_.any_at_most(j, c_, m_.safe_code);
  }

  /// The longest shot that is safely below clipping; where there is none, the shortest that shows the sample.
  void first_guess() {
    std::fill_n(radiance_, kTile, -1.0f);
    std::fill_n(measured_, kTile, 0.0f);
    bool missing = true;
    for (int j = task_.count - 1; j >= 0 && missing; --j) {
      if (!may_be_safe(j)) continue;
      missing = guess_from(j);
    }
    bool unsure = false;
    for (int k = 0; k < kTile; ++k) unsure = unsure || measured_[k] == 0;
    if (unsure) look_at_all(missing);
  }

  bool guess_from(int j) {
    const float* levels = level_of(j);
    const VF per_exposure = hn::Set(f, 1 / task_.shots[j].exposure);
    bool missing = false;
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
      const VF level = level_at(levels, j, k), before = hn::Load(f, radiance_ + k);
      const MF open = hn::Lt(before, hn::Zero(f));
      const MF safe = hn::And(hn::Ge(level, hn::Zero(f)), hn::Le(level, hn::Set(f, m_.near_clip)));
      const MF found = hn::And(open, safe);
      hn::Store(hn::IfThenElse(found, hn::Mul(level, per_exposure), before), f, radiance_ + k);
      const MF light =
          hn::And(found, hn::And(hn::Gt(level, hn::Set(f, m_.black_bound)), hn::Lt(level, hn::Set(f, m_.clip_bound))));
      hn::Store(hn::IfThenElse(light, hn::Set(f, 1.0f), hn::Load(f, measured_ + k)), f, measured_ + k);
      missing = missing || !hn::AllFalse(f, hn::AndNot(safe, open));
    }
    return missing;
  }

  /// Samples whose reference is black, or that have none.
  void look_at_all(bool missing) {
    HWY_ALIGN float shortest[kTile];
    HWY_ALIGN float bright[kTile];
    HWY_ALIGN float guessed[kTile];
    std::fill_n(shortest, kTile, 0.0f);
    std::fill_n(bright, kTile, -1.0f);
    std::copy_n(measured_, kTile, guessed);
    for (int j = task_.count - 1; j >= 0; --j) {
      const float* levels = level_of(j);
      const VF per_exposure = hn::Set(f, 1 / task_.shots[j].exposure);
      for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
        const VF level = level_at(levels, j, k);
        const MF light = hn::And(hn::Gt(level, hn::Set(f, m_.black_bound)), hn::Lt(level, hn::Set(f, m_.clip_bound)));
        hn::Store(hn::IfThenElse(light, hn::Set(f, 1.0f), hn::Load(f, measured_ + k)), f, measured_ + k);
        const MF shown = hn::Ge(level, hn::Zero(f));
        const VF before = hn::Load(f, shortest + k);
        hn::Store(hn::IfThenElse(shown, hn::Mul(level, per_exposure), before), f, shortest + k);
        const MF close = hn::And(light, hn::Gt(level, hn::Set(f, m_.near_clip)));
        hn::Store(hn::IfThenElse(close, hn::Mul(level, per_exposure), hn::Load(f, bright + k)), f, bright + k);
      }
    }
    for (int k = 0; missing && k < kTile; ++k) radiance_[k] = radiance_[k] < 0 ? shortest[k] : radiance_[k];
    for (int k = 0; k < kTile; ++k) radiance_[k] = guessed[k] == 0 && bright[k] >= 0 ? bright[k] : radiance_[k];
  }

  /// A step of Fisher's scoring where chosen_ says so. Is another one needed?
  bool score() {
    std::fill_n(sum_, kTile, 0.0f);
    std::fill_n(total_, kTile, 0.0f);
    std::fill_n(censored_, kTile, 0.0f);
    std::copy_n(chosen_, kTile, active_);
    for (int j = task_.count - 1; j >= 0; --j) {
      bool any_active = false, any_expected = false;
      const VF exposure = hn::Set(f, task_.shots[j].exposure), beyond = hn::Set(f, m_.beyond_clip);
      for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
        const MF active = hn::Gt(hn::Load(f, active_ + k), hn::Zero(f));
        const MF inside = hn::Le(hn::Mul(hn::Load(f, radiance_ + k), exposure), beyond);
        any_active = any_active || !hn::AllFalse(f, active);
        any_expected = any_expected || !hn::AllFalse(f, hn::And(active, inside));
      }
      if (task_.skip_tiles && !any_active) break;
      if (task_.skip_tiles && !any_expected) continue;
      const float* levels = level_of(j);
      for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) add(level_at(levels, j, k), exposure, k);
    }
    const VF floor = hn::Set(f, m_.dark * (1 / task_.shots[task_.count - 1].exposure));
    const VF least = hn::Set(f, std::numeric_limits<float>::min());
    bool again = false;
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
      const MF chosen = hn::Gt(hn::Load(f, chosen_ + k), hn::Zero(f));
      const VF total = hn::Load(f, total_ + k);
      const VF value = hn::Max(floor, hn::Div(hn::Load(f, sum_ + k), hn::Max(total, least)));
      hn::Store(hn::IfThenElse(chosen, value, hn::Load(f, radiance_ + k)), f, radiance_ + k);
      hn::Store(hn::IfThenElse(chosen, total, hn::Load(f, precision_ + k)), f, precision_ + k);
      const VF censored = hn::Load(f, censored_ + k);
      again = again || !hn::AllFalse(f, hn::Gt(censored, hn::Zero(f)));
      hn::Store(censored, f, chosen_ + k);
    }
    return again;
  }

  HWY_INLINE void add(VF level, VF exposure, int k) {
    MF active = hn::Gt(hn::Load(f, active_ + k), hn::Zero(f));
    const VF expected = hn::Mul(hn::Load(f, radiance_ + k), exposure);
    const MF needed = hn::And(active, hn::Le(expected, hn::Set(f, m_.beyond_clip)));
    if (hn::AllFalse(f, needed)) return;
    const VF per_level = precision_at(m_, expected), precision = hn::Mul(per_level, exposure);
    const MF clipped = hn::Ge(level, hn::Set(f, m_.clip_bound)), black = hn::Le(level, hn::Set(f, m_.black_bound));
    const MF near_clip = hn::Ge(expected, hn::Set(f, m_.near_clip));
    const MF near = hn::And(needed, hn::Or(near_clip, hn::Le(expected, hn::Set(f, m_.near_black))));
    const MF cut = hn::Or(clipped, black);
    VF weight = hn::Mul(precision, exposure), term = level;
    MF used = hn::And(needed, hn::Ge(level, hn::Zero(f)));
    if (HWY_UNLIKELY(!hn::AllFalse(f, near))) {
      const VF inverse = hn::Sqrt(per_level), deviation = hn::Div(hn::Set(f, 1.0f), inverse);
      const CensoringTable& table = *censoring_;
      const VI to_clip = censoring_bin(hn::Mul(hn::Sub(hn::Set(f, m_.clip_bound), expected), inverse));
      const VI to_black = censoring_bin(hn::Mul(hn::Sub(expected, hn::Set(f, m_.black_bound)), inverse));
      const VF both = hn::Add(gather(table.information.data(), to_clip), gather(table.information.data(), to_black));
      const VF information = hn::Max(hn::Zero(f), hn::Sub(both, hn::Set(f, 1.0f)));
      const VF over = hn::Mul(deviation, gather(table.excess.data(), to_clip));
      const VF under = hn::Sub(hn::Zero(f), hn::Mul(deviation, gather(table.excess.data(), to_black)));
      const VF excess = hn::IfThenElse(clipped, over, hn::IfThenElse(black, under, hn::Sub(level, expected)));
      term = hn::IfThenElse(near, hn::Add(hn::Mul(information, expected), excess), level);
      weight = hn::IfThenElse(near, hn::Mul(weight, information), weight);
    }
    const VF total = hn::Load(f, total_ + k);
    const MF small = hn::And(needed, hn::AndNot(near_clip, hn::Lt(hn::Mul(weight, hn::Set(f, 256.0f)), total)));
    used = hn::AndNot(small, hn::AndNot(hn::AndNot(near, cut), used));
    hn::Store(hn::Add(hn::Load(f, sum_ + k), hn::IfThenElseZero(used, hn::Mul(precision, term))), f, sum_ + k);
    hn::Store(hn::Add(total, hn::IfThenElseZero(used, weight)), f, total_ + k);
    hn::Store(hn::IfThenElse(small, hn::Zero(f), hn::Load(f, active_ + k)), f, active_ + k);
    const VF one = hn::Set(f, 1.0f);
    hn::Store(hn::IfThenElse(hn::And(used, near), one, hn::Load(f, censored_ + k)), f, censored_ + k);
  }

  const MergeRowTask& task_;
  Tile<Code>& tile_;
  int x_, c_;
  const ChannelModel& m_;
  const CensoringTable* censoring_ = &censoring_table();
  std::vector<char> looked_up_;
  HWY_ALIGN float radiance_[kTile];
  HWY_ALIGN float precision_[kTile];
  HWY_ALIGN float measured_[kTile];
  HWY_ALIGN float chosen_[kTile];
  HWY_ALIGN float sum_[kTile];
  HWY_ALIGN float total_[kTile];
  HWY_ALIGN float active_[kTile];
  HWY_ALIGN float censored_[kTile];
  HWY_ALIGN float closing_shot_[kTile];
};

// ---- rows

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
    closes[c].assign(samples, 0);
  }
}

TileCount merge_row(const MergeRowTask& task, MergeRowScratch& scratch) {
  return HWY_DYNAMIC_DISPATCH(merge_row_on_target)(task, scratch);
}

}  // namespace hdr::internal
#endif
