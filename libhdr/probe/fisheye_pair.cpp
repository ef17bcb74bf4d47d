#include "libhdr/probe/fisheye_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/median.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/overlap_ring.h"
#include "libhdr/probe/internal/same_pixels.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

using namespace internal;

constexpr int kLeastMatches = 12;

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
  double residual = 0;
  // Again from where the first fit leads: what then lies near is matched.
  for (const double reach_degrees : {6.0, 1.5}) {
    const Ring ring = ring_of(pair.views[0], pair.views[1], pixels_per_radian(pair.views[0].lens));
    std::vector<Match> matches;
    if (ring.height > 0) {
      matches = match_rings(unroll(front, pair.views[0], ring), unroll(back, pair.views[1], ring), ring, pair.views[0],
                            pair.views[1], reach_degrees * kDegree);
    }
    pair.matches = static_cast<int>(matches.size());
    if (pair.matches < kLeastMatches) {
      throw Error(
          fmt::format("the two fisheyes have {} features in common where they should overlap; give --circle "
                      "and --fov, or photographs that share a border",
                      pair.matches));
    }
    residual = fit_pair(matches, pair);
  }
  pair.residual_degrees = residual / kDegree;
  match_gains(front, back, pair);
  return pair;
}

}  // namespace hdr
