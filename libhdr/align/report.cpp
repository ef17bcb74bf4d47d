#include "libhdr/align/internal/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/align/internal/still.h"

namespace hdr::internal {
namespace {

double moved_px(const MotionFrame& frame, const Place& place) {
  return frame.farthest_between(place.photo_from_ref, Mat3::Identity());
}

/// A shot without usable pixels lies, in exposure order, between two that have some: as does its place, until measured.
FrameAlignment between(const MotionFrame& frame, const Bracket& bracket, int k, int before, int after,
                       const std::vector<FrameAlignment>& frames) {
  FrameAlignment row;
  row.skipped = "no usable pixels";
  if (before < 0 && after < 0) return row;
  const Mat3& low = frames[static_cast<std::size_t>(before < 0 ? after : before)].ref_from_photo;
  const Mat3& high = frames[static_cast<std::size_t>(after < 0 ? before : after)].ref_from_photo;
  double share = 0;
  if (before >= 0 && after >= 0) {
    const auto ln_h = [&](int shot) {
      return std::log(bracket.shots[static_cast<std::size_t>(shot)].relative_exposure());
    };
    share = ln_h(after) > ln_h(before) ? (ln_h(k) - ln_h(before)) / (ln_h(after) - ln_h(before)) : 0.5;
  }
  row.ref_from_photo = low;
  if (low != high) row.ref_from_photo = frame.motion((1 - share) * frame.vector(low) + share * frame.vector(high));
  return row;
}

/// Root mean square of how far a usable shot lies from the next one: how far an unseen one may have moved.
double typical_motion(const MotionFrame& frame, const std::vector<int>& used,
                      const std::vector<FrameAlignment>& frames) {
  // What no shot tells is taken for one pixel: as much as a merge bears.
  constexpr double kUnknown = 1;
  if (used.size() < 2) return kUnknown;
  double squares = 0;
  for (std::size_t k = 1; k < used.size(); ++k) {
    const FrameAlignment &a = frames[static_cast<std::size_t>(used[k - 1])],
                         &b = frames[static_cast<std::size_t>(used[k])];
    const double apart = frame.rms_between(a.ref_from_photo, b.ref_from_photo);
    squares += apart * apart + std::max(a.residual_px * a.residual_px, b.residual_px * b.residual_px);
  }
  return std::sqrt(squares / static_cast<double>(used.size() - 1));
}

}  // namespace

bool bracket_stays(const MotionFrame& frame, const std::vector<Place>& places) {
  constexpr double kNeverPx = 1;         // farther off, staying is never right
  constexpr double kResamplingPx = 0.1;  // what resampling costs, as the shift that would blur as much
  double stay = 0, move = 0, farthest = 0, largest = 0;
  for (const Place& place : places) {
    if (!place.trouble.empty()) continue;  // it goes where its neighbour goes
    const double moved = frame.rms_between(place.photo_from_ref, Mat3::Identity());
    stay += moved * moved;
    move += place.error_px * place.error_px + kResamplingPx * kResamplingPx;
    largest = std::max(largest, moved);
    farthest = std::max(farthest, moved_px(frame, place));
  }
  return farthest < kStillPx || (largest < kNeverPx && stay <= move);
}

FrameAlignment decided(const MotionFrame& frame, const Place& place, bool bracket_still) {
  FrameAlignment row;
  const double moved = moved_px(frame, place);
  row.residual_px = place.error_px;
  row.inliers = place.inliers;
  if (!place.trouble.empty()) {
    row.skipped = fmt::format("not measured against its neighbour, moves with it: {}", place.trouble);
    if (bracket_still) return row;
  } else if (bracket_still || lies_still(moved, place.error_px)) {
    // What is left uncorrected is the measured motion itself, and its error.
    row.residual_px = std::hypot(moved, place.error_px);
    const char* why = moved < kStillPx ? "registered already, within {:.2f} px"
                                       : "within {:.2f} px: moving this bracket would bring its shots no nearer";
    row.skipped = fmt::format(fmt::runtime(why), std::max(0.01, moved + 2 * place.error_px));
    return row;
  }
  row.ref_from_photo = place.photo_from_ref.inverse();
  row.ref_from_photo /= row.ref_from_photo(2, 2);
  return row;
}

void place_unusable(const Bracket& bracket, const std::vector<int>& used, std::vector<FrameAlignment>& frames) {
  const MotionFrame frame(bracket.size());
  const double doubt = typical_motion(frame, used, frames);
  for (int k = 0; k < static_cast<int>(frames.size()); ++k) {
    const auto after = std::lower_bound(used.begin(), used.end(), k);
    if (after != used.end() && *after == k) continue;
    FrameAlignment& row = frames[static_cast<std::size_t>(k)];
    row = between(frame, bracket, k, after == used.begin() ? -1 : *(after - 1), after == used.end() ? -1 : *after,
                  frames);
    row.residual_px = doubt;
  }
}

}  // namespace hdr::internal
