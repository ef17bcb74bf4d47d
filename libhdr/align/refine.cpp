// Sub-pixel registration: robust, masked Gauss-Newton in log radiance, coarse to fine [Bergen92], with the motion model
// that the pictures support.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libhdr/align/internal/evidence.h"
#include "libhdr/align/internal/pair.h"

namespace hdr::internal {
namespace {

constexpr std::size_t kFewestPixels = 64;
constexpr double kLargestError = 0.75;      // pixels of the level; beyond, the content does not fix the motion
constexpr double kAliasing = 0.007;         // pixels of the level in each axis: detail beyond Nyquist moves by itself
constexpr double kMedianOfNormal = 0.6745;  // median |z| of a standard normal
constexpr double kLeastUnmoved = 0.3;       // of the pixels in common, those that are unmoved too
constexpr double kFewestTilesToStay = 2;    // for each unknown of the model that there is

/// Where the iterations stand at one level.
struct Estimate {
  Mat3 motion = Mat3::Identity();  ///< of photograph pixels, at which the last linearisation was made
  Step step;                       ///< and where it leads under the model
  MotionModel model = MotionModel::kTranslation;
  PhotometricMatch match;
  Linearization at;
  double median = 0;  ///< of |residual| / sigma
  bool enough = false;

  Mat3 stepped(const MotionFrame& frame) const { return motion * frame.motion(step.motion); }
};

/// A step stays within the reach of the linearisation: `reach` pixels.
void shorten(const MotionFrame& frame, Step& step, double reach) {
  const double length = frame.farthest_between(Mat3::Identity(), frame.motion(step.motion));
  if (length > reach) step.motion *= reach / length;
}

/// Root mean square of how far two motions take what was compared: beyond it, little evidence extrapolates far.
double apart_where_seen(const Linearization& at, const Mat3& one, const Mat3& other) {
  double squares = 0, weights = 1e-30;
  for (const TileSums& tile : at.tiles) {
    const double weight = tile.xx + tile.yy;
    squares += weight * (moved(one, tile.middle) - moved(other, tile.middle)).squaredNorm();
    weights += weight;
  }
  return std::sqrt(squares / weights);
}

/// Iterates (motion, match) or, when `move` is false, the photometric match alone.
void iterate(const MotionFrame& frame, const LogPicture& a, const LogPicture& b, Estimate& e, int iterations,
             bool move) {
  constexpr double kConverged = 0.003, kNearly = 0.02, kLongestStep = 2, kLost = 4;  // pixels of the level
  const Mat3 start = e.motion;
  for (int k = 0;; ++k) {
    e.at = linearize(a, b, e.motion, e.match);
    e.enough = e.at.pixels >= kFewestPixels;
    if (!e.enough) return;
    e.median = e.at.median_magnitude();
    const Evidence evidence(frame, e.at, e.match);
    if (const MotionModel richest = evidence.richest();
        e.model > richest && evidence.effective_tiles() < kFewestTilesToStay * unknowns(e.model)) {
      // Less to go by than there was at another level. (A little less is no reason: where it comes and goes with the
      // motion, a model that came and went with it would never settle.)
      e.motion = evidence.nearest(e.motion, richest);
      e.model = richest;
      if (k < iterations) continue;
    }
    e.step = evidence.step(e.model, move);
    e.enough = e.step.finite();
    if (!e.enough) return;
    shorten(frame, e.step, kLongestStep * a.cell);
    // While the residuals shrink, so does the cut beyond which pixels are outliers: small steps may still lead far.
    const double change = std::abs(e.median / kMedianOfNormal / e.match.scale - 1);
    const double small = change < 0.03 ? kNearly : kConverged;
    const bool settled = move && std::isfinite(e.match.scale) && e.step.motion.norm() < small * a.cell;
    if (k == iterations || settled) return;
    e.motion = e.stepped(frame);
    e.match.value += e.step.match;
    e.match.scale = std::max(e.median / kMedianOfNormal, 1e-3);
    if (apart_where_seen(e.at, start, e.motion) > kLost * a.cell) return;
  }
}

/// The same with the model that the pictures support, never a poorer one than before.
void iterate_models(const MotionFrame& frame, const LogPicture& a, const LogPicture& b, Estimate& e, int iterations) {
  iterate(frame, a, b, e, iterations, true);
  while (e.enough && e.model != MotionModel::kProjective) {
    const auto costs = Evidence(frame, e.at, e.match).costs(e.motion, kAliasing * a.cell);
    const MotionModel better = cheapest(costs);
    if (unknowns(better) <= unknowns(e.model)) return;
    // Freedom helps a wrong match as well: only what agrees already may have more of it.
    if (agreement(a, b, e.motion).value_or(0) < kLeastInliers) return;
    const Estimate before = e;
    e.model = better;
    iterate(frame, a, b, e, iterations, true);
    if (!e.enough || e.model <= before.model) {  // there it had too little to go by
      e = before;
      return;
    }
  }
}

/// Geman-McClure's mean loss, which the iterations lower, at a common scale.
double mean_loss(const Estimate& e, double scale) {
  double sum = 0;
  for (const float magnitude : e.at.magnitudes) {
    const double m2 = std::pow(magnitude / (3 * scale), 2);
    sum += m2 / (1 + m2);
  }
  return e.at.magnitudes.empty() ? 0 : sum / static_cast<double>(e.at.magnitudes.size());
}

/// Why the answer does not explain the pictures better than no motion does; or empty.
std::string no_better_than_still(const MotionFrame& frame, const LogPicture& a, const LogPicture& b,
                                 const Estimate& e) {
  if (frame.rms_between(e.motion, Mat3::Identity()) < 0.25 * a.cell) return "";
  Estimate still;
  still.match = e.match;
  iterate(frame, a, b, still, 2, false);
  // What is usable in one shot and in the other may not meet but where a shift makes it: such a match proves nothing.
  if (!still.enough || static_cast<double>(still.at.pixels) < kLeastUnmoved * static_cast<double>(e.at.pixels)) {
    return "unmoved they have too few pixels in common";
  }
  const double scale = std::max(e.median, 1e-3) / kMedianOfNormal;
  return mean_loss(e, scale) > 1.01 * mean_loss(still, scale) ? "moving it would not match its neighbour better" : "";
}

/// Why too few tiles agree on the motion, as a failed pair; else nullopt, and `inliers` is their share.
std::optional<PairMotion> disagreeing(Size size, const LogPicture& a, const LogPicture& b, const Mat3& b_from_a,
                                      double& inliers) {
  const std::optional<double> share = agreement(a, b, b_from_a);
  if (!share) return failed("they share no texture above their noise");
  inliers = *share;
  if (inliers >= kLeastInliers) return std::nullopt;
  return failed(fmt::format("only {:.0f} % of what they share agrees on one motion", 100 * inliers), inliers,
                searched_px(size));
}

/// Does the content fix the motion in every direction? Along stripes there are the gradients of noise alone, which fix
/// nothing. (Where all directions are alike, what both pictures show has been found to agree.)
bool fixed_in_all_directions(const Linearization& at) {
  constexpr double kLeastOverNoise = 1.5, kAlike = 0.05, kLeast = 1e-3;
  Mat2 sum = Mat2::Zero();
  double noise = 0;
  for (const TileSums& tile : at.tiles) {
    sum(0, 0) += tile.xx;
    sum(1, 1) += tile.yy;
    sum(0, 1) += tile.xy;
    noise += tile.noise;
  }
  const double mean = 0.5 * sum.trace();
  const double least = mean - std::hypot(0.5 * (sum(0, 0) - sum(1, 1)), sum(0, 1));
  return least > kAlike * mean || (least > kLeast * mean && least > kLeastOverNoise * noise);
}

/// Where the compared pixels lie, weighted by what they say.
void locate(const Linearization& at, PairMotion& motion) {
  Vec2 sum = Vec2::Zero();
  Mat2 squares = 1e-12 * Mat2::Identity();
  double weights = 1e-30;
  for (const TileSums& tile : at.tiles) {
    sum += (tile.xx + tile.yy) * tile.middle;
    weights += tile.xx + tile.yy;
  }
  motion.middle = sum / weights;
  for (const TileSums& tile : at.tiles) {
    const Vec2 away = tile.middle - motion.middle;
    squares += (tile.xx + tile.yy) / weights * away * away.transpose();
  }
  motion.spread = Eigen::LLT<Mat2>(squares).matrixL();
}

/// What the estimate at the finest level is worth.
PairMotion measured(const MotionFrame& frame, const LogPicture& a, const Estimate& e, double inliers) {
  if (!e.enough) return failed("too few pixels in common");
  const Evidence evidence(frame, e.at, e.match);
  const double floor = kAliasing * a.cell;
  PairMotion motion;
  motion.model = e.model;
  motion.richest = std::max(e.model, evidence.richest());
  motion.price = evidence.price();
  locate(e.at, motion);
  motion.inliers = inliers;
  motion.b_from_a = e.stepped(frame);
  for (std::size_t k = 0; k < kMotionModels.size(); ++k) {
    const int m = unknowns(kMotionModels[k]);
    if (m > unknowns(motion.richest) && m > 2) break;
    const Step step = evidence.step(kMotionModels[k]);
    motion.measured[k].step = frame.vector(motion.b_from_a.inverse() * e.motion * frame.motion(step.motion));
    motion.measured[k].covariance = step.covariance;
    motion.measured[k].covariance.diagonal().head(m).array() += floor * floor;
  }
  const double error = std::sqrt(evidence.step(MotionModel::kTranslation).covariance.trace());
  if (!(error < kLargestError * a.cell) || !fixed_in_all_directions(e.at)) {
    return failed(fmt::format("its content does not fix the motion (error {:.2g} px)", error), inliers);
  }
  return motion;
}

/// A rival that is as good, a period of a pattern away; its distance, or 0.
double equal_rival(const Pyramid& a, const Pyramid& b, const Estimate& e) {
  constexpr double kAsGood = 1.2;
  const MotionFrame frame(a.size);
  PairMotion place;
  locate(e.at, place);
  for (const Vec2& period : repeats(a, place.middle)) {
    for (const double sign : {1.0, -1.0}) {
      Estimate rival = e;
      rival.motion = e.motion * shift_by(sign * period);
      iterate(frame, a.levels[0], b.levels[0], rival, 2, true);
      const double scale = std::max(e.median, 1e-3) / kMedianOfNormal;
      if (rival.enough && mean_loss(rival, scale) < kAsGood * mean_loss(e, scale)) return period.norm();
    }
  }
  return 0;
}

/// Coarse to fine from `start` down to level `last`.
Estimate descend(const MotionFrame& frame, std::span<const LogPicture> a, std::span<const LogPicture> b,
                 const Mat3& start, std::size_t last) {
  constexpr int kIterations = 10, kMatchIterations = 4;
  Estimate e;
  e.match = unmatched(a[last]);
  Mat3 motion = start;
  for (std::size_t level = a.size(); level-- > last;) {
    const double cell = a[level].cell;
    Estimate next = e;
    next.motion = motion;
    // Before the first step the photometric match must know which pixels are outliers, or they would lead it.
    if (!std::isfinite(next.match.scale)) {
      iterate(frame, a[level], b[level], next, kMatchIterations, false);
      next.motion = motion;
    }
    iterate_models(frame, a[level], b[level], next, kIterations);
    // A coarse level may have too little in common, or lead astray: then the finer ones speak for themselves.
    const bool trusted = next.enough && frame.rms_between(next.motion, motion) < 3 * cell;
    if (level > last && !trusted) continue;
    motion = next.stepped(frame);
    e = std::move(next);
  }
  return e;
}

/// Small for a match in many pixels: a wrong motion matches a few by chance.
double badness(const Estimate& e) {
  return e.enough ? e.median / std::sqrt(static_cast<double>(e.at.pixels)) : std::numeric_limits<double>::infinity();
}

}  // namespace

PairMotion shift_motion(Size size, const Vec2& shift, const Mat2& covariance) {
  PairMotion motion;
  motion.b_from_a = shift_by(shift);
  motion.middle = MotionFrame(size).middle;
  motion.spread.diagonal() << 0.29 * size.width, 0.29 * size.height;  // the whole picture
  motion.measured[0].covariance.topLeftCorner<2, 2>() = covariance;
  motion.inliers = 1;
  return motion;
}

PairMotion refine_motion(const Pyramid& a, const Pyramid& b, std::span<const Mat3> starts) {
  constexpr double kNoiseLevel = 1.0;  // a median residual of about a standard deviation needs no rival
  const MotionFrame frame(a.size);
  const std::size_t coarse = a.coarse();
  const LogPicture &ca = a.levels[coarse], &cb = b.levels[coarse];
  Estimate best;
  for (const Mat3& start : starts) {
    Estimate e = descend(frame, a.levels, b.levels, start, coarse);
    if (badness(e) < badness(best)) best = std::move(e);
    if (best.enough && &start == &starts.front() && best.median < kNoiseLevel) break;
  }
  if (!best.enough) return failed("too few pixels in common");
  constexpr double kMostTurn = 30;  // degrees; a hand does not turn a camera farther between two shots
  const double turn = frame.vector(best.motion)[2] / frame.radius * 180 / std::numbers::pi;
  if (std::abs(turn) > kMostTurn) {
    return failed(fmt::format("it is turned by {:.0f} degrees; rotate the file", turn), 0, frame.radius);
  }
  double inliers = 0;
  if (const auto trouble = disagreeing(a.size, ca, cb, best.stepped(frame), inliers)) return *trouble;
  if (const std::string why = no_better_than_still(frame, ca, cb, best); !why.empty()) return failed(why, inliers);
  if (coarse > 0) {
    best.motion = best.stepped(frame);
    iterate_models(frame, a.levels[0], b.levels[0], best, 12);
    // Coarse tiles forgive some pixels, where few are usable: then the finest detail must agree as well.
    if (best.enough && inliers < kClean) {
      const std::optional<double> fine = agreement(a.levels[0], b.levels[0], best.stepped(frame));
      inliers = std::min(inliers, fine.value_or(inliers));
      if (inliers < kLeastInliers) {
        return failed(fmt::format("only {:.0f} % of their fine detail agrees on one motion", 100 * inliers), inliers,
                      searched_px(a.size));
      }
    }
  }
  if (const double period = best.enough ? equal_rival(a, b, best) : 0; period > 0) {
    return failed(fmt::format("its pattern repeats every {:.1f} px, and another match is as good", period), inliers,
                  period);
  }
  return measured(frame, a.levels[0], best, inliers);
}

PairMotion polish_motion(const Pyramid& a, const Pyramid& b, const Mat3& start, MotionModel model) {
  const MotionFrame frame(a.size);
  const std::size_t coarse = a.coarse();
  Estimate e;
  e.motion = start;
  e.model = model;
  e.match = unmatched(a.levels[coarse]);
  // The match, and what it takes for outliers, are found for less at the coarse level.
  iterate(frame, a.levels[coarse], b.levels[coarse], e, 3, false);
  if (!e.enough) return failed("too few pixels in common");
  e.motion = start;
  double inliers = 0;
  if (const auto trouble = disagreeing(a.size, a.levels[coarse], b.levels[coarse], start, inliers)) return *trouble;
  // Two steps do where the neighbours were right; where little is usable they may have been far off elsewhere.
  constexpr int kIterations = 8;
  iterate_models(frame, a.levels[0], b.levels[0], e, kIterations);
  return measured(frame, a.levels[0], e, inliers);
}

PairMotion refine_in_place(Size size, const LogPicture& a, const LogPicture& b, double inliers,
                           const std::function<void(Linearization&)>& place) {
  constexpr int kMatchIterations = 3;
  if (inliers < kLeastInliers) return failed("its tiles do not agree that nothing moved", inliers);
  const MotionFrame frame(size);
  Estimate e;
  e.match = unmatched(a);
  iterate(frame, a, b, e, kMatchIterations, false);
  if (!e.enough) return failed("too few pixels in common");
  place(e.at);
  const Evidence evidence(frame, e.at, e.match);
  e.model = cheapest(evidence.costs(e.motion, kAliasing * a.cell));
  e.step = evidence.step(e.model);
  return measured(frame, a, e, inliers);
}

PairMotion assess_shift(const Pyramid& a, const Pyramid& b, const Vec2& b_from_a) {
  const MotionFrame frame(a.size);
  Estimate e;
  e.motion = shift_by(b_from_a);
  e.match = unmatched(a.levels[0]);
  iterate(frame, a.levels[0], b.levels[0], e, 3, false);
  if (!e.enough) return failed("too few pixels in common");
  const double inliers = agreement(a.levels[0], b.levels[0], e.motion).value_or(0);
  if (const std::string why = no_better_than_still(frame, a.levels[0], b.levels[0], e); !why.empty()) {
    return failed(why, inliers);
  }
  const Mat2 covariance = e.step.covariance.topLeftCorner<2, 2>();
  if (!(std::sqrt(covariance.trace()) < kLargestError * a.levels[0].cell)) {
    return failed("its content does not fix the motion", inliers);
  }
  PairMotion motion = shift_motion(a.size, b_from_a, covariance);
  motion.inliers = inliers;
  return motion;
}

}  // namespace hdr::internal
