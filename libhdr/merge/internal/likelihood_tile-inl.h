// One channel of a tile by maximum likelihood.
// Compiled once a target, as Highway's -inl.h files are: the guard toggles.
#include <limits>
#include <vector>

#include "libhdr/merge/internal/tile-inl.h"

#if defined(HDR_MERGE_LIKELIHOOD_TILE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HDR_MERGE_LIKELIHOOD_TILE_INL_H_
#undef HDR_MERGE_LIKELIHOOD_TILE_INL_H_
#else
#define HDR_MERGE_LIKELIHOOD_TILE_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {
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
      // Of a mean whose weights are trust times precision; with full trust the second root is 1.
      const VF safe = hn::IfThenElse(measured, total, hn::Set(f, 1.0f));
      const VF over = hn::Sqrt(hn::Div(hn::IfThenElse(measured, hn::Load(f, spread_ + k), safe), safe));
      const VF deviation = hn::Mul(hn::Div(saturation, hn::Sqrt(safe)), over);
      hn::Store(hn::IfThenElseZero(measured, deviation), f, out.stddev + k);
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

  /// Levels of shot j; negative outside the photograph, where it is not trusted, and after a closing code.
  HWY_INLINE VF level_at(const float* levels, int j, int k) const {
    VF level = hn::LoadU(f, levels + k);
    if (const float* trust = task_.shots[j].trust) {
      level = hn::IfThenElse(hn::Gt(hn::LoadU(f, trust + x_ + k), hn::Zero(f)), level, hn::Set(f, -1.0f));
    }
    if (!task_.model->lossy) return level;
    const MF closed = hn::Lt(hn::Load(f, closing_shot_ + k), hn::Set(f, static_cast<float>(j)));
    return hn::IfThenElse(closed, hn::Set(f, -1.0f), level);
  }

  void find_closing_shots() {
    std::fill_n(closing_shot_, kTile, static_cast<float>(task_.count));
    const auto c = static_cast<std::size_t>(c_);
    for (int j = task_.count - 1; j >= 0; --j) {
      const float* trust = task_.shots[j].trust;
      const auto trusted = [&](int k) { return !trust || trust[x_ + k] > 0; };
      if (const WarpedRow* warped = task_.shots[j].warped) {
        for (int k = 0; k < kTile; ++k) {
          const bool closes = warped->closes[c][static_cast<std::size_t>(x_ + k)] && trusted(k);
          closing_shot_[k] = closes ? static_cast<float>(j) : closing_shot_[k];
        }
      } else if (tile_.any_above(j, c_, task_.model->closing_code - 1)) {
        const Code* codes = tile_.plane(j, c_);
        for (int k = 0; k < kTile; ++k) {
          if (codes[k] >= task_.model->closing_code && trusted(k)) closing_shot_[k] = static_cast<float>(j);
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
    std::fill_n(squares_, kTile, 0.0f);
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
      for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) add(j, level_at(levels, j, k), exposure, k);
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
      hn::Store(hn::IfThenElse(chosen, hn::Load(f, squares_ + k), hn::Load(f, spread_ + k)), f, spread_ + k);
      const VF censored = hn::Load(f, censored_ + k);
      again = again || !hn::AllFalse(f, hn::Gt(censored, hn::Zero(f)));
      hn::Store(censored, f, chosen_ + k);
    }
    return again;
  }

  /// What the samples of shot j tell of the mean, as a share of what a pixel of its own would, and how far they are
  /// believed.
  HWY_INLINE void shares(int j, int k, VF& information, VF& trust) const {
    const ShotRow& shot = task_.shots[j];
    information = trust = hn::Set(f, 1.0f);
    if (shot.warped) {
      const auto c = static_cast<std::size_t>(c_);
      information = hn::LoadU(f, shot.warped->information[c].data() + x_ + k);
      trust = hn::LoadU(f, shot.warped->trust[c].data() + x_ + k);
    }
    if (shot.trust) trust = hn::Mul(trust, hn::LoadU(f, shot.trust + x_ + k));
  }

  HWY_INLINE void add(int j, VF level, VF exposure, int k) {
    MF active = hn::Gt(hn::Load(f, active_ + k), hn::Zero(f));
    const VF expected = hn::Mul(hn::Load(f, radiance_ + k), exposure);
    const MF needed = hn::And(active, hn::Le(expected, hn::Set(f, m_.beyond_clip)));
    if (hn::AllFalse(f, needed)) return;
    VF information, trust;
    shares(j, k, information, trust);
    const VF per_level = hn::Mul(precision_at(m_, expected), information);
    const VF precision = hn::Mul(hn::Mul(per_level, trust), exposure);
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
      const VF told = hn::Max(hn::Zero(f), hn::Sub(both, hn::Set(f, 1.0f)));
      const VF over = hn::Mul(deviation, gather(table.excess.data(), to_clip));
      const VF under = hn::Sub(hn::Zero(f), hn::Mul(deviation, gather(table.excess.data(), to_black)));
      const VF excess = hn::IfThenElse(clipped, over, hn::IfThenElse(black, under, hn::Sub(level, expected)));
      term = hn::IfThenElse(near, hn::Add(hn::Mul(told, expected), excess), level);
      weight = hn::IfThenElse(near, hn::Mul(weight, told), weight);
    }
    const VF total = hn::Load(f, total_ + k);
    const MF less = hn::Lt(hn::Mul(weight, hn::Set(f, 256.0f)), hn::Mul(total, trust));
    const MF small = hn::And(needed, hn::AndNot(near_clip, less));
    used = hn::AndNot(small, hn::AndNot(hn::AndNot(near, cut), used));
    hn::Store(hn::Add(hn::Load(f, sum_ + k), hn::IfThenElseZero(used, hn::Mul(precision, term))), f, sum_ + k);
    hn::Store(hn::Add(total, hn::IfThenElseZero(used, weight)), f, total_ + k);
    const VF squares = hn::Add(hn::Load(f, squares_ + k), hn::IfThenElseZero(used, hn::Mul(weight, trust)));
    hn::Store(squares, f, squares_ + k);
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
  HWY_ALIGN float spread_[kTile];  ///< precision times trust, summed as precision_ is
  HWY_ALIGN float measured_[kTile];
  HWY_ALIGN float chosen_[kTile];
  HWY_ALIGN float sum_[kTile];
  HWY_ALIGN float total_[kTile];
  HWY_ALIGN float squares_[kTile];
  HWY_ALIGN float active_[kTile];
  HWY_ALIGN float censored_[kTile];
  HWY_ALIGN float closing_shot_[kTile];
};
}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
