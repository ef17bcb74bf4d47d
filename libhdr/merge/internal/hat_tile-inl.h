// One channel of a tile under the hat.
// Compiled once a target, as Highway's -inl.h files are: the guard toggles.
#include <limits>

#include "libhdr/merge/internal/tile-inl.h"

#if defined(HDR_MERGE_HAT_TILE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HDR_MERGE_HAT_TILE_INL_H_
#undef HDR_MERGE_HAT_TILE_INL_H_
#else
#define HDR_MERGE_HAT_TILE_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {
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
    for_each_shot([&](int k, VF open, VF weight, VF weight_light, VF, float exposure) HWY_ATTR {
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
    for_each_shot([&](int k, VF open, VF weight, VF, VF information, float exposure) HWY_ATTR {
      const VF radiance = hn::Mul(hn::Load(f, out.value + k), per_saturation);
      const VF precision = hn::Mul(precision_at(m_, hn::Mul(radiance, hn::Set(f, exposure))), information);
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
  /// add(k, open, weight, weight_light, information, exposure) for each vector of each shot that may have something to
  /// add.
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
        if (closable) all_closed = close_trusted(j);
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
      const float* trust = task_.shots[j].trust;
      VF weight = gather(m_.weight.data(), index), weight_light = gather(m_.weight_light.data(), index);
      if (trust) believe(trust + x_ + k, weight, weight_light);
      add(k, open, weight, weight_light, hn::Set(f, 1.0f), task_.shots[j].exposure);
      if (!closable) continue;
      MF stays = hn::RebindMask(f, hn::Gt(closing, index));
      if (trust) stays = hn::Or(stays, hn::Le(hn::LoadU(f, trust + x_ + k), hn::Zero(f)));
      hn::Store(hn::IfThenElseZero(stays, open), f, open_ + k);
    }
  }

  template <class Add>
  HWY_INLINE void add_warped(int j, bool closable, const Add& add) {
    const WarpedRow& row = *task_.shots[j].warped;
    const float* trust = task_.shots[j].trust;
    const auto c = static_cast<std::size_t>(c_);
    for (int k = 0; k < kTile; k += static_cast<int>(hn::Lanes(f))) {
      VF weight = hn::LoadU(f, row.weight[c].data() + x_ + k);
      VF weight_light = hn::LoadU(f, row.weight_light[c].data() + x_ + k);
      if (trust) believe(trust + x_ + k, weight, weight_light);
      add(k, hn::Load(f, open_ + k), weight, weight_light, hn::LoadU(f, row.information[c].data() + x_ + k),
          task_.shots[j].exposure);
    }
    if (!closable) return;
    for (int k = 0; k < kTile; ++k) {
      const bool closes = row.closes[c][static_cast<std::size_t>(x_ + k)] && (!trust || trust[x_ + k] > 0);
      open_[k] = closes ? 0.0f : open_[k];
    }
  }

  static HWY_INLINE void believe(const float* trust, VF& weight, VF& weight_light) {
    const VF share = hn::LoadU(f, trust);
    weight = hn::Mul(weight, share);
    weight_light = hn::Mul(weight_light, share);
  }

  /// Shot j is clipped in all of the tile, and so are the shots that follow, where it is believed. Everywhere?
  bool close_trusted(int j) {
    const float* trust = task_.shots[j].trust;
    bool all = true;
    for (int k = 0; k < kTile; ++k) {
      const bool closes = !trust || trust[x_ + k] > 0;
      open_[k] = closes ? 0.0f : open_[k];
      all = all && closes;
    }
    return all;
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
}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
