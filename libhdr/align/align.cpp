#include "libhdr/align/align.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "libhdr/align/internal/pair.h"
#include "libhdr/align/internal/still.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/rows.h"

namespace hdr {
namespace {

using internal::LogPicture;
using internal::PairMotion;

constexpr double kFewestUsable = 0.02;   // share of the pixels below which a shot says nothing about its place
constexpr double kFinestPixels = 1.2e6;  // pixels of the finest level: more would not find the shift better
constexpr int kCoarsestSide = 40;

std::vector<double> usable_shares(const Bracket& bracket) {
  std::vector<double> shares(bracket.shots.size());
  for_rows(static_cast<int>(shares.size()), 1, [&](int first, int) {
    const auto k = static_cast<std::size_t>(first);
    shares[k] = internal::usable_share(bracket.shots[k]);
  });
  return shares;
}

/// The shot with the largest share of usable pixels; of those within 1 % of it, the one nearest to the middle.
int best_exposed(const std::vector<double>& shares) {
  if (shares.empty()) return 0;
  const double largest = *std::max_element(shares.begin(), shares.end());
  // A shot that can be registered is better than one that cannot.
  const double least = largest < kFewestUsable ? largest - 0.01 : std::max(kFewestUsable, largest - 0.01);
  const double middle = 0.5 * (static_cast<double>(shares.size()) - 1);
  int best = -1;
  for (int k = 0; k < static_cast<int>(shares.size()); ++k) {
    if (shares[static_cast<std::size_t>(k)] < least) continue;
    if (best < 0 || std::abs(k - middle) < std::abs(best - middle)) best = k;
  }
  return best;
}

Mat3 translation(const Vec2& shift) {
  Mat3 m = Mat3::Identity();
  m.topRightCorner<2, 1>() = shift;
  return m;
}

/// One shot, at every scale that Gauss-Newton visits, the finest first.
std::vector<LogPicture> pyramid_of(const Photo& photo, const internal::Linearizer& linearizer) {
  int cell = 1;
  while (static_cast<double>(photo.width() / cell) * (photo.height() / cell) > kFinestPixels) cell *= 2;
  std::vector<LogPicture> levels;
  LogPicture sharp = internal::log_picture(photo, linearizer, cell, 1);
  while (true) {
    levels.push_back(internal::smoothed(sharp, 2));
    if (std::min(sharp.ln.width(), sharp.ln.height()) < 2 * kCoarsestSide) return levels;
    sharp = internal::halved(sharp);
  }
}

/// What one shot of a pair is remembered by while its neighbours are visited.
struct Prepared {
  std::optional<LoadedShot> shot;  ///< for median threshold bitmaps alone
  LogPicture thumbnail;
  std::vector<LogPicture> pyramid;
};

Prepared prepare(const Photo& photo, const internal::Linearizer& linearizer, AlignMethod method) {
  LoadedShot shot(photo);
  if (method == AlignMethod::kMtb) return {std::move(shot), {}, {}};
  return {std::nullopt, internal::thumbnail(*shot, linearizer), pyramid_of(*shot, linearizer)};
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
  if (method == AlignMethod::kMtb) return internal::mtb_shift(**a.shot, **b.shot);
  if (method == AlignMethod::kFeatures) return internal::feature_shift(a.pyramid.front(), b.pyramid.front());
  // Where the thumbnails correlate; or else where they were.
  constexpr std::size_t kMostStarts = 5;
  std::vector<Vec2> starts = internal::search_shifts(a.thumbnail, b.thumbnail, internal::kSearchRadius, kMostStarts);
  starts.emplace_back(0, 0);
  if (method == AlignMethod::kEcc) return internal::ecc_shift(a.pyramid, b.pyramid, starts.front());
  PairMotion motion = internal::refine_shift(a.pyramid, b.pyramid, starts);
  if (motion.trouble.empty()) return motion;
  // A second start, from what has corners; or their own answer, where no one shift fits all pixels (a turned camera).
  const PairMotion features = internal::feature_shift(a.pyramid.front(), b.pyramid.front());
  if (!features.trouble.empty()) return motion;
  motion = internal::refine_shift(a.pyramid, b.pyramid, {&features.b_from_a, 1});
  return motion.trouble.empty() ? motion : features;
}

/// Motions of neighbours among the shots `used`, two shots in memory at a time.
std::vector<PairMotion> measure_pairs(const Bracket& bracket, const std::vector<int>& used,
                                      const internal::Linearizer& linearizer, AlignMethod method) {
  std::vector<PairMotion> motions;
  std::optional<Prepared> previous;
  const auto make = [&](int k) { return prepare(bracket.shots[static_cast<std::size_t>(k)], linearizer, method); };
  visit_in_order(used, method == AlignMethod::kMtb ? 1 : 2, make, [&](Prepared next) {
    if (previous) motions.push_back(measure(*previous, next, method));
    previous = std::move(next);
    return true;
  });
  return motions;
}

/// The cheap question first: nullopt as soon as one pair has moved.
std::optional<std::vector<PairMotion>> still_pairs(const Bracket& bracket, const std::vector<int>& used,
                                                   const internal::Linearizer& linearizer) {
  std::vector<PairMotion> motions;
  std::optional<internal::StillProbe> previous;
  const auto make = [&](int k) {
    return internal::still_probe(*LoadedShot(bracket.shots[static_cast<std::size_t>(k)]), linearizer);
  };
  bool moved = false;
  visit_in_order(used, 2, make, [&](internal::StillProbe next) {
    const std::optional<PairMotion> motion = previous ? internal::still_motion(*previous, next) : std::nullopt;
    moved = previous && !motion;
    if (motion) motions.push_back(*motion);
    previous = std::move(next);
    return !moved;
  });
  return moved ? std::nullopt : std::optional(std::move(motions));
}

/// A shot's place on the reference, before decisions.
struct Place {
  Vec2 photo_from_ref = Vec2::Zero();
  double variance = 0;  ///< px^2
  std::string trouble;
};

/// Adds up the motions from the reference outwards, and their variances. `reference` indexes the chain.
std::vector<Place> chained(const std::vector<PairMotion>& motions, int reference) {
  double squares = 0;
  int good = 0;
  for (const PairMotion& m : motions) {
    if (!m.trouble.empty()) continue;
    squares += m.b_from_a.squaredNorm();
    ++good;
  }
  // A pair that could not be measured has moved as much as the others have: that is the doubt it adds.
  const double typical = good > 0 ? squares / good : 1.0;
  std::vector<Place> places(motions.size() + 1);
  const auto extend = [&](std::size_t from, std::size_t to, const PairMotion& m, double sign) {
    places[to].photo_from_ref = places[from].photo_from_ref + sign * m.b_from_a;
    places[to].variance = places[from].variance + (m.trouble.empty() ? m.covariance.trace() : typical);
    places[to].trouble = m.trouble;
  };
  const auto ref = static_cast<std::size_t>(reference);
  for (std::size_t k = ref; k < motions.size(); ++k) extend(k, k + 1, motions[k], +1);
  for (std::size_t k = ref; k > 0; --k) extend(k, k - 1, motions[k - 1], -1);
  return places;
}

bool all_still(const std::vector<Place>& places) {
  return std::all_of(places.begin(), places.end(), [](const Place& p) {
    return p.trouble.empty() && internal::bracket_lies_still(p.photo_from_ref.norm());
  });
}

FrameAlignment decided(const Place& place, bool bracket_still) {
  FrameAlignment frame;
  const double error = std::sqrt(place.variance), moved = place.photo_from_ref.norm();
  frame.residual_px = error;
  if (!place.trouble.empty()) {
    frame.skipped = fmt::format("not measured against its neighbour, moves with it: {}", place.trouble);
  } else if (bracket_still || internal::lies_still(place.photo_from_ref, error)) {
    // What is left uncorrected is the measured shift itself, and its error.
    frame.residual_px = std::hypot(moved, error);
    frame.skipped = fmt::format("registered already, within {:.2f} px", std::max(0.01, moved + 2 * error));
    return frame;
  }
  frame.ref_from_photo = translation(-place.photo_from_ref);
  return frame;
}

/// A shot without usable pixels lies, in exposure order, between two that have some: as does its place, until measured.
FrameAlignment between(const Bracket& bracket, int k, int before, int after,
                       const std::vector<FrameAlignment>& frames) {
  FrameAlignment frame;
  frame.skipped = "no usable pixels";
  if (before < 0 && after < 0) return frame;
  const FrameAlignment& low = frames[static_cast<std::size_t>(before < 0 ? after : before)];
  const FrameAlignment& high = frames[static_cast<std::size_t>(after < 0 ? before : after)];
  double share = 0;
  if (before >= 0 && after >= 0) {
    const auto ln_h = [&](int shot) {
      return std::log(bracket.shots[static_cast<std::size_t>(shot)].relative_exposure());
    };
    share = ln_h(after) > ln_h(before) ? (ln_h(k) - ln_h(before)) / (ln_h(after) - ln_h(before)) : 0.5;
  }
  frame.ref_from_photo = (1 - share) * low.ref_from_photo + share * high.ref_from_photo;
  return frame;
}

/// Root mean square of how far a usable shot lies from the next one: how far an unseen one may have moved.
double typical_motion(const std::vector<int>& used, const std::vector<FrameAlignment>& frames) {
  double squares = 0;
  for (std::size_t k = 1; k < used.size(); ++k) {
    const Mat3 apart = frames[static_cast<std::size_t>(used[k])].ref_from_photo -
                       frames[static_cast<std::size_t>(used[k - 1])].ref_from_photo;
    squares += apart.topRightCorner<2, 1>().squaredNorm();
  }
  return used.size() < 2 ? 0 : std::sqrt(squares / static_cast<double>(used.size() - 1));
}

void place_unusable(const Bracket& bracket, const std::vector<int>& used, std::vector<FrameAlignment>& frames) {
  const double doubt = typical_motion(used, frames);
  for (int k = 0; k < static_cast<int>(frames.size()); ++k) {
    const auto after = std::lower_bound(used.begin(), used.end(), k);
    if (after != used.end() && *after == k) continue;
    FrameAlignment& frame = frames[static_cast<std::size_t>(k)];
    frame = between(bracket, k, after == used.begin() ? -1 : *(after - 1), after == used.end() ? -1 : *after, frames);
    frame.residual_px = doubt;
  }
}

}  // namespace

std::optional<AlignMethod> align_method_from_name(const std::string& name) {
  if (name == "auto") return AlignMethod::kAuto;
  if (name == "none") return AlignMethod::kNone;
  if (name == "mtb") return AlignMethod::kMtb;
  if (name == "ecc") return AlignMethod::kEcc;
  if (name == "features") return AlignMethod::kFeatures;
  return std::nullopt;
}

bool Alignment::identity() const {
  return std::all_of(frames.begin(), frames.end(),
                     [](const FrameAlignment& f) { return f.ref_from_photo == Mat3::Identity(); });
}

std::vector<Mat3> Alignment::ref_from_photo() const {
  std::vector<Mat3> transforms;
  for (const FrameAlignment& frame : frames) transforms.push_back(frame.ref_from_photo);
  return transforms;
}

Alignment no_alignment(const Bracket& bracket) {
  Alignment alignment;
  alignment.reference = best_exposed(usable_shares(bracket));
  alignment.frames.resize(bracket.shots.size());
  for (FrameAlignment& frame : alignment.frames) frame.skipped = "not asked for";
  return alignment;
}

Alignment align(const Bracket& bracket, const Response& response, AlignMethod method) {
  if (method == AlignMethod::kNone) return no_alignment(bracket);
  const std::vector<double> shares = usable_shares(bracket);
  Alignment alignment;
  alignment.reference = best_exposed(shares);
  alignment.frames.resize(bracket.shots.size());
  std::vector<int> used;
  for (int k = 0; k < static_cast<int>(shares.size()); ++k) {
    if (shares[static_cast<std::size_t>(k)] >= kFewestUsable) used.push_back(k);
  }
  if (!used.empty()) {
    const bool lossy = std::any_of(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.lossy; });
    const internal::Linearizer linearizer(response, bracket.bits(), lossy);
    const int reference_in_chain =
        static_cast<int>(std::lower_bound(used.begin(), used.end(), alignment.reference) - used.begin());
    HDR_ASSERT(used[static_cast<std::size_t>(reference_in_chain)] == alignment.reference);
    std::vector<Place> places;
    if (method == AlignMethod::kAuto) {
      if (const auto motions = still_pairs(bracket, used, linearizer)) places = chained(*motions, reference_in_chain);
    }
    if (places.empty() || !all_still(places)) {
      places = chained(measure_pairs(bracket, used, linearizer, method), reference_in_chain);
    }
    const bool still = all_still(places);
    for (std::size_t k = 0; k < used.size(); ++k) {
      alignment.frames[static_cast<std::size_t>(used[k])] = decided(places[k], still);
    }
    // The reference is the grid itself. It is reported as skipped only when everything is.
    auto& reference = alignment.frames[static_cast<std::size_t>(alignment.reference)];
    reference = {};
    if (still) reference.skipped = "the reference: every shot lies on it";
  }
  place_unusable(bracket, used, alignment.frames);
  return alignment;
}

}  // namespace hdr
