#include "libhdr/align/internal/pairs.h"

#include <algorithm>
#include <span>
#include <type_traits>
#include <utility>

#include "libhdr/align/internal/still.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/rows.h"

namespace hdr::internal {
namespace {

constexpr double kFinestPixels = 1.2e6;  // pixels of the finest level: more would not find the motion better
constexpr int kCoarsestSide = 40;

Pyramid pyramid_of(const Photo& photo, const Linearizer& linearizer) {
  int cell = 1;
  while (static_cast<double>(photo.width() / cell) * (photo.height() / cell) > kFinestPixels) cell *= 2;
  Pyramid pyramid{photo.size(), {}};
  LogPicture sharp = log_picture(photo.codes, photo.relative_exposure(), linearizer, cell, 1);
  while (true) {
    pyramid.levels.push_back(smoothed(sharp, 2));
    if (std::min(sharp.ln.width(), sharp.ln.height()) < 2 * kCoarsestSide) return pyramid;
    sharp = halved(sharp);
  }
}

/// What one shot is remembered by while its neighbours are visited.
struct Prepared {
  std::optional<LoadedShot> shot;  ///< for median threshold bitmaps alone
  LogPicture thumbnail;
  Pyramid pyramid;
};

Prepared prepare(const Photo& photo, const Linearizer& linearizer, AlignMethod method) {
  LoadedShot shot(photo);
  if (method == AlignMethod::kMtb) return {std::move(shot), {}, {}};
  const std::shared_ptr<const PhotoSamples> samples = samples_of(photo.samples ? photo : *shot);
  return {std::nullopt, thumbnail(*samples, photo.relative_exposure(), linearizer), pyramid_of(*shot, linearizer)};
}

/// make(shot) for each of `used`, up to `ahead` of them side by side, since a shot may have to be decoded for it; and
/// visit(made) one by one in their order, until it returns false.
template <class Make, class Visit>
void visit_in_order(const std::vector<int>& used, std::size_t ahead, const Make& make, const Visit& visit) {
  for (std::size_t begin = 0; begin < used.size(); begin += ahead) {
    std::vector<std::invoke_result_t<Make, int>> made(std::min(ahead, used.size() - begin));
    for_rows(static_cast<int>(made.size()), 1, [&](int first, int) {
      const auto i = static_cast<std::size_t>(first);
      made[i] = make(used[begin + i]);
    });
    for (auto& each : made) {
      if (!visit(std::move(each))) return;
    }
  }
}

PairMotion measure(const Prepared& a, const Prepared& b, AlignMethod method) {
  if (method == AlignMethod::kMtb) return mtb_shift(**a.shot, **b.shot);
  if (method == AlignMethod::kFeatures) return feature_motion(a.pyramid, b.pyramid);
  // Where the thumbnails correlate; or else where they were.
  constexpr std::size_t kMostStarts = 5;
  std::vector<Vec2> shifts = search_shifts(a.thumbnail, b.thumbnail, kSearchRadius, kMostStarts);
  shifts.emplace_back(0, 0);
  if (method == AlignMethod::kEcc) return ecc_shift(a.pyramid, b.pyramid, shifts.front());
  std::vector<Mat3> starts;
  for (const Vec2& shift : shifts) starts.push_back(shift_by(shift));
  // Of the tiles so many agree: no other motion can do much better.
  const auto clean = [](const PairMotion& motion) { return motion.trouble.empty() && motion.inliers > kClean; };
  PairMotion best = refine_motion(a.pyramid, b.pyramid, starts);
  if (clean(best)) return best;
  const auto compete = [&](std::span<const Mat3> from) {
    PairMotion rival = refine_motion(a.pyramid, b.pyramid, from);
    if (!rival.trouble.empty()) return;
    if (!best.trouble.empty() || rival.inliers > best.inliers) best = std::move(rival);
  };
  // Other starts: turned, where a few usable pixels let a turn pass for a shift; and from what has corners, far away.
  constexpr std::size_t kMostTurns = 3;
  const std::vector<Mat3> turns = search_turns(a.thumbnail, b.thumbnail, a.pyramid.size, kSearchRadius, kMostTurns);
  if (!turns.empty()) compete(turns);
  if (clean(best)) return best;
  const PairMotion features = feature_motion(a.pyramid, b.pyramid);
  if (features.trouble.empty()) compete({&features.b_from_a, 1});
  return best;
}

/// The shots over the last but one: the motion that its neighbours promise, made better, or a new search.
PairMotion measure_over(const Prepared& a, const Prepared& c, const PairMotion& ab, const PairMotion& bc,
                        AlignMethod method) {
  if (method != AlignMethod::kAuto || !ab.trouble.empty() || !bc.trouble.empty()) return measure(a, c, method);
  return polish_motion(a.pyramid, c.pyramid, bc.b_from_a * ab.b_from_a, std::max(ab.model, bc.model));
}

}  // namespace

std::vector<MeasuredPair> measure_pairs(const Bracket& bracket, const std::vector<int>& used,
                                        const Linearizer& linearizer, AlignMethod method) {
  std::vector<MeasuredPair> pairs;
  std::vector<Prepared> window;  // the last two
  PairMotion last;
  const bool close_loops = method != AlignMethod::kMtb;
  int k = 0;
  const auto make = [&](int shot) {
    return prepare(bracket.shots[static_cast<std::size_t>(shot)], linearizer, method);
  };
  visit_in_order(used, close_loops ? 2 : 1, make, [&](Prepared next) {
    if (!window.empty()) {
      const PairMotion motion = measure(window.back(), next, method);
      pairs.push_back({k - 1, k, motion});
      if (window.size() > 1 && close_loops) {
        pairs.push_back({k - 2, k, measure_over(window.front(), next, last, motion, method)});
      }
      last = motion;
    }
    window.push_back(std::move(next));
    if (window.size() > (close_loops ? 2 : 1)) window.erase(window.begin());
    ++k;
    return true;
  });
  return pairs;
}

std::optional<std::vector<MeasuredPair>> still_pairs(const Bracket& bracket, std::span<const SharedSamples> samples,
                                                     const std::vector<int>& used, const Linearizer& linearizer) {
  std::vector<std::unique_ptr<StillProbe>> probes(used.size());
  for_rows(static_cast<int>(used.size()), 1, [&](int k, int) {
    const auto shot = static_cast<std::size_t>(used[static_cast<std::size_t>(k)]);
    probes[static_cast<std::size_t>(k)] = std::make_unique<StillProbe>(bracket.shots[shot], samples[shot], linearizer);
  });
  // What a few pixels tell of all pairs comes before what many tell of one: one that moved ends the question.
  std::vector<StillPair> pairs;
  for (std::size_t k = 1; k < used.size(); ++k) {
    pairs.emplace_back(*probes[k - 1], *probes[k]);
    if (pairs.back().ask_few().stillness == Stillness::kMoved) return std::nullopt;
  }
  std::vector<MeasuredPair> measured;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    StillAnswer answer = pairs[k].ask_all();
    if (answer.stillness == Stillness::kMoved) return std::nullopt;
    if (answer.stillness == Stillness::kUnclear) {
      // This pair alone is looked at as closely as can be: whether the bracket stays, all pairs together will tell.
      const auto prepared = [&](const StillProbe& probe) {
        return prepare(probe.photo(), linearizer, AlignMethod::kAuto);
      };
      answer.motion = measure(prepared(*probes[k]), prepared(*probes[k + 1]), AlignMethod::kAuto);
      if (!answer.motion.trouble.empty()) return std::nullopt;
    }
    measured.push_back({static_cast<int>(k), static_cast<int>(k + 1), std::move(answer.motion)});
    probes[k]->forget_whole();
  }
  return measured;
}

}  // namespace hdr::internal
