#include "libhdr/probe/fisheye_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/median.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/overlap_ring.h"
#include "libhdr/probe/internal/rotation_consensus.h"
#include "libhdr/probe/internal/same_pixels.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

using namespace internal;

constexpr std::size_t kLeastMatches = 12;
constexpr double kMostResidual = 0.7;  ///< degrees; a two-fisheye camera held in a hand has .15

double pixels_per_radian(const Fisheye& lens) {
  return lens.disc.r / (0.5 * lens.fov_degrees * kDegree);
}

/// ln of one over the other where both show something.
std::vector<double> log_ratios(View<const float> front, View<const float> back) {
  std::vector<double> ratios;
  for (int y = 0; y < front.height(); y += 2) {
    for (int x = 0; x < front.width(); x += 2) {
      const float *p = front.pixel(x, y), *q = back.pixel(x, y);
      if (p[0] != p[0] || q[0] != q[0]) continue;
      const double a = luminance<double>(p[0], p[1], p[2]), b = luminance<double>(q[0], q[1], q[2]);
      if (a > 0 && b > 0) ratios.push_back(std::log(a / b));
    }
  }
  return ratios;
}

/// Features of both rings that look alike within `reach` radians; the rings are as much wider as asked for.
std::vector<Match> matches_of(View<const float> front, View<const float> back, const FisheyePair& pair, double fineness,
                              double reach, double margin) {
  const auto& [a, b] = pair.views;
  const Ring ring = ring_of(a, b, fineness * pixels_per_radian(a.lens), margin);
  if (ring.height == 0) return {};
  return match_rings(unroll(front, a, ring), unroll(back, b, ring), ring, a, b, reach);
}

/// Evenly chosen: more would not make the fit surer.
std::vector<Match> thinned(const std::vector<Match>& matches) {
  constexpr std::size_t kMost = 1500;
  if (matches.size() <= kMost) return matches;
  std::vector<Match> fewer;
  for (std::size_t k = 0; k < kMost; ++k) fewer.push_back(matches[k * matches.size() / kMost]);
  return fewer;
}

/// Somebody who turns a tripod's head by hand is some degrees off: coarse features from far around, and the rotation on
/// which most of them agree. Without enough that do, the lenses stay back to back.
void turn_roughly(View<const float> front, View<const float> back, FisheyePair& pair) {
  constexpr double kReach = 16 * kDegree, kMargin = 10 * kDegree, kAllowed = 2.5 * kDegree, kLeastShare = 0.3;
  const std::vector<Match> matches = matches_of(front, back, pair, 0.5, kReach, kMargin);
  const auto& [a, b] = pair.views;
  RayPairs rays;
  for (const Match& match : matches) {
    const auto p = a.lens.dir_from_px(match.front), q = b.lens.dir_from_px(match.back);
    if (!p || !q) continue;
    rays.a.push_back(*p);
    rays.b.push_back(*q);
  }
  if (rays.a.size() < kLeastMatches) return;
  const Consensus found = consensus(rays, kAllowed, 0x5e);
  const std::size_t agreeing = inliers_of(rays, found.a_from_b, kAllowed).size();
  if (agreeing < kLeastMatches || static_cast<double>(agreeing) < kLeastShare * static_cast<double>(rays.a.size()))
    return;
  pair.views[1].probe_from_view = found.a_from_b;
}

void match_gains(View<const float> front, View<const float> back, FisheyePair& pair) {
  pair.views[0].gain = pair.views[1].gain = 1;
  const Ring ring = ring_of(pair.views[0], pair.views[1], 0.5 * pixels_per_radian(pair.views[0].lens));
  if (ring.height == 0) return;
  std::vector<double> ratios = log_ratios(unroll(front, pair.views[0], ring), unroll(back, pair.views[1], ring));
  const double ln_gain = median_of(ratios);
  pair.views[1].gain = std::exp(ln_gain);
  std::vector<double> deviations;
  for (const double r : ratios) deviations.push_back(std::abs(r - ln_gain));
  constexpr double kSigmaOfMedian = 1.4826;
  pair.overlap_rms = kSigmaOfMedian * median_of(deviations);
}

}  // namespace

namespace internal {

void require_overlap(const Fisheye& front, const Fisheye& back) {
  require_valid(front);
  require_valid(back);
  const double both = front.fov_degrees + back.fov_degrees;
  if (both > 360) return;
  throw Error(fmt::format("fisheyes of {} and {} degrees leave a gap between them; give their --fov, above 180",
                          front.fov_degrees, back.fov_degrees));
}

}  // namespace internal

FisheyePair solve_fisheye_pair(View<const float> front, View<const float> back, const Fisheye& front_guess,
                               const Fisheye& back_guess) {
  require_overlap(front_guess, back_guess);
  if (same_pixels(front, back)) throw Error("the same photograph twice; give what the opposite lens saw");
  FisheyePair pair;
  pair.views[0].lens = front_guess;
  pair.views[1].lens = back_guess;
  pair.views[1].probe_from_view = rotation_from_degrees({0, 180, 0});
  turn_roughly(front, back, pair);
  double residual = 0;
  // Again from where the first fit leads: what then lies near is matched.
  for (const double reach_degrees : {6.0, 1.5}) {
    const std::vector<Match> matches = matches_of(front, back, pair, 1, reach_degrees * kDegree, 0);
    pair.matches = static_cast<int>(matches.size());
    if (matches.size() < kLeastMatches) {
      throw Error(
          fmt::format("the two fisheyes have {} features in common where they should overlap; give --circle "
                      "and --fov, or photographs that share a border",
                      pair.matches));
    }
    residual = fit_pair(thinned(matches), pair);
  }
  pair.residual_degrees = residual / kDegree;
  if (!(pair.residual_degrees <= kMostResidual)) {
    throw Error(
        fmt::format("the two fisheyes do not fit: features that should meet are {:.1f} degrees apart; give --circle, "
                    "--fov and --lens",
                    pair.residual_degrees));
  }
  match_gains(front, back, pair);
  return pair;
}

}  // namespace hdr
