// Sub-pixel registration: robust, masked Gauss-Newton in log radiance, coarse to fine.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libhdr/align/internal/gauss_newton.h"
#include "libhdr/align/internal/pair.h"

namespace hdr::internal {
namespace {

constexpr std::size_t kFewestPixels = 64;
constexpr double kLargestError = 0.75;      // pixels of the level; beyond, the content does not fix the motion
constexpr double kAliasing = 0.007;         // pixels of the level in each axis: detail beyond Nyquist moves by itself
constexpr double kMedianOfNormal = 0.6745;  // median |z| of a standard normal

/// Where the iterations stand at one level, in pixels of that level.
struct Estimate {
  Vec2 t = Vec2::Zero();
  Mat2 covariance = Mat2::Zero();
  PhotometricMatch match;
  double median = 0;              ///< of |residual| / sigma at t
  std::vector<float> magnitudes;  ///< |residual| / sigma at t, of a sample of the pixels
  std::size_t pixels = 0;
  bool enough = false;
};

/// Knots that few pixels speak for follow their neighbours in a straight line: a faint penalty on second differences.
Hessian bending_penalty(const Hessian& hessian) {
  const double strength = 1e-4 * hessian.diagonal().tail<kKnots>().sum() + 1e-12;
  Hessian penalty = Hessian::Zero();
  for (int k = 2; k + 2 < kUnknowns; ++k) {
    Unknowns bend = Unknowns::Zero();
    bend.segment<3>(k) = Vec3(1, -2, 1);
    penalty += strength * bend * bend.transpose();
  }
  return penalty;
}

/// A trace of regularisation keeps a constant picture solvable: its shift is then 0, its error huge.
Hessian inverse_of(Hessian h) {
  h.diagonal().head<2>().array() += 1e-12;
  h.diagonal().tail<kKnots>().array() += 1e-9 * h.diagonal().tail<kKnots>().sum() + 1e-12;
  return h.ldlt().solve(Hessian::Identity());
}

/// The sandwich of [White80] with tiles as its independent observations: H^-1 (sum s s^t) H^-1. Honest about noise that
/// neighbours share, moved content and an approximate response alike, since it uses the residuals that are there.
Mat2 covariance_of_shift(const Linearization& at, const Hessian& inverse) {
  Mat2 covariance = Mat2::Zero();
  for (const Unknowns& s : at.tile_scores) {
    const Vec2 pull = inverse.topRows<2>() * s;
    covariance += pull * pull.transpose();
  }
  return covariance;
}

/// Where Gauss-Newton would go next, without the shift when `move` is false.
Unknowns step_from(const Linearization& at, const PhotometricMatch& match, bool move, Mat2& covariance) {
  const Hessian penalty = bending_penalty(at.hessian);
  Unknowns m = Unknowns::Zero();
  m.tail<kKnots>() = match.value;
  const Unknowns slope = at.score + penalty * m;
  const Hessian inverse = inverse_of(at.hessian + penalty);
  covariance = covariance_of_shift(at, inverse);
  if (move) return -(inverse * slope);
  // With t held, its rows and columns leave the system; what it would have moved is part of its doubt.
  const Vec2 refused = inverse.topRows<2>() * slope;
  covariance += refused * refused.transpose();
  Hessian held = at.hessian + penalty;
  held.topRows<2>().setZero();
  held.leftCols<2>().setZero();
  held.topLeftCorner<2, 2>().setIdentity();
  Unknowns d = -(inverse_of(held) * slope);
  d.head<2>().setZero();
  return d;
}

/// Iterates (t, match) or, when `move` is false, the photometric match alone.
Estimate iterate(const LogPicture& a, const LogPicture& b, Estimate e, int iterations, bool move) {
  constexpr double kConverged = 0.003, kLongestStep = 1.5, kLost = 4;
  const Vec2 start = e.t;
  for (int k = 0; k <= iterations; ++k) {
    Linearization at = linearize(a, b, e.t, e.match);
    e.pixels = at.pixels;
    e.enough = at.pixels >= kFewestPixels;
    if (!e.enough) return e;
    e.median = at.median_magnitude();
    e.magnitudes = std::move(at.magnitudes);
    const Unknowns d = step_from(at, e.match, move, e.covariance);
    if (!d.allFinite()) {
      e.enough = false;
      return e;
    }
    if (k == iterations) break;
    // Each step stays within the reach of the linearisation.
    Vec2 step = d.head<2>();
    if (step.norm() > kLongestStep) step *= kLongestStep / step.norm();
    const bool settled = move && step.norm() < kConverged && std::isfinite(e.match.scale);
    e.t += step;
    e.match.value += d.tail<kKnots>();
    e.match.scale = std::max(e.median / kMedianOfNormal, 1e-3);
    if (settled || (e.t - start).norm() > kLost) break;
  }
  return e;
}

/// Geman-McClure's mean loss, which the iterations lower.
double mean_loss(const Estimate& e, double scale) {
  double sum = 0;
  for (const float magnitude : e.magnitudes) {
    const double m2 = std::pow(magnitude / (3 * scale), 2);
    sum += m2 / (1 + m2);
  }
  return e.magnitudes.empty() ? 0 : sum / static_cast<double>(e.magnitudes.size());
}

/// What the estimate at the finest level is worth.
PairMotion judged(const LogPicture& a, const LogPicture& b, const Estimate& e) {
  if (!e.enough) return failed("too few pixels in common");
  PairMotion motion;
  motion.b_from_a = e.t * a.cell;
  motion.covariance = (e.covariance + kAliasing * kAliasing * Mat2::Identity()) * (a.cell * a.cell);
  if (!(std::sqrt(e.covariance.trace()) < kLargestError)) {
    return failed(fmt::format("its content does not fix the motion (error {:.2g} px)", motion.error_px()));
  }
  // The answer must explain the pictures better than no motion does.
  if (e.t.norm() > 0.25) {
    Estimate still;
    still.match = e.match;
    still = iterate(a, b, still, 2, false);
    // What is usable in one shot and in the other may not meet but where a shift makes it: such a match proves nothing.
    if (!still.enough) return failed("unmoved they have too few pixels in common");
    const double scale = std::max(e.median, 1e-3) / kMedianOfNormal;
    if (mean_loss(e, scale) > 1.01 * mean_loss(still, scale))
      return failed("moving it would not match its neighbour better");
  }
  return motion;
}

/// Coarse to fine from `start` (photograph pixels) down to level `last`. The answer is in pixels of that level.
Estimate descend(std::span<const LogPicture> a, std::span<const LogPicture> b, const Vec2& start, std::size_t last) {
  constexpr int kIterations = 10, kMatchIterations = 4;
  Estimate e;
  e.match = unmatched(a.front());
  Vec2 shift = start;
  for (std::size_t level = a.size(); level-- > last;) {
    const double cell = a[level].cell;
    Estimate next = e;
    next.t = shift / cell;
    // Before the first step the photometric match must know which pixels are outliers, or they would lead it.
    if (!std::isfinite(next.match.scale)) next = iterate(a[level], b[level], next, kMatchIterations, false);
    next = iterate(a[level], b[level], next, kIterations, true);
    // A coarse level may have too little in common, or lead astray: then the finer ones speak for themselves.
    const bool trusted = next.enough && (next.t * cell - shift).norm() < 3 * cell;
    if (level > last && !trusted) continue;
    e = next;
    shift = e.t * cell;
  }
  return e;
}

/// Small for a match in many pixels: a wrong shift matches a few by chance.
double badness(const Estimate& e) {
  return e.enough ? e.median / std::sqrt(static_cast<double>(e.pixels)) : std::numeric_limits<double>::infinity();
}

}  // namespace

PairMotion refine_shift(std::span<const LogPicture> a, std::span<const LogPicture> b, std::span<const Vec2> starts) {
  constexpr double kNoiseLevel = 1.0;  // a median residual of about a standard deviation needs no rival
  const std::size_t coarse = a.size() > 1 ? 1 : 0;
  // Rivals are told apart at the last level but one, for a quarter of the work.
  Estimate best;
  for (const Vec2& start : starts) {
    const Estimate e = descend(a, b, start, coarse);
    if (badness(e) < badness(best)) best = e;
    if (best.enough && &start == &starts.front() && best.median < kNoiseLevel) break;
  }
  if (!best.enough) return failed("too few pixels in common");
  const Vec2 found = best.t * a[coarse].cell;
  return judged(a.front(), b.front(), descend(a.first(1), b.first(1), found, 0));
}

PairMotion assess_shift(const LogPicture& a, const LogPicture& b, const Vec2& b_from_a) {
  Estimate e;
  e.t = b_from_a / a.cell;
  e.match = unmatched(a);
  return judged(a, b, iterate(a, b, e, 3, false));
}

}  // namespace hdr::internal
