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
constexpr double kMedianOfNormal = 0.6745;  // median |z| of a standard normal

/// Where the iterations stand at one level, in pixels of that level.
struct Estimate {
  Vec2 t = Vec2::Zero();
  Mat2 covariance = Mat2::Zero();
  PhotometricMatch match;
  double median = 0;  ///< of |residual| / sigma at t
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
    e.enough = at.pixels >= kFewestPixels;
    if (!e.enough) return e;
    e.median = at.median_magnitude();
    const Unknowns d = step_from(at, e.match, move, e.covariance);
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

/// What the estimate at the finest level is worth.
PairMotion judged(const LogPicture& a, const LogPicture& b, const Estimate& e) {
  if (!e.enough) return failed("too few pixels in common");
  PairMotion motion;
  motion.b_from_a = e.t * a.cell;
  motion.covariance = e.covariance * (a.cell * a.cell);
  if (!(std::sqrt(e.covariance.trace()) < kLargestError)) {
    return failed(fmt::format("its content does not fix the motion (error {:.2g} px)", motion.error_px()));
  }
  // The answer must explain the pictures better than no motion does.
  if (e.t.norm() > 0.25) {
    Estimate still;
    still.match = e.match;
    still = iterate(a, b, still, 2, false);
    if (still.enough && e.median > 1.02 * still.median) return failed("moving it would not match its neighbour better");
  }
  return motion;
}

}  // namespace

PairMotion refine_shift(std::span<const LogPicture> a, std::span<const LogPicture> b, const Vec2& start) {
  Estimate e;
  if (!a.empty()) e.match = unmatched(a.front());
  int level = static_cast<int>(std::min(a.size(), b.size())) - 1;
  if (level < 0) return failed("no pixels");
  Vec2 shift = start;
  for (; level >= 0; --level) {
    const LogPicture& pa = a[static_cast<std::size_t>(level)];
    const LogPicture& pb = b[static_cast<std::size_t>(level)];
    Estimate at_level = e;
    at_level.t = shift / pa.cell;
    at_level = iterate(pa, pb, at_level, 10, true);
    if (!at_level.enough && level > 0) continue;
    if (!at_level.enough) return failed("too few pixels in common");
    if ((at_level.t * pa.cell - shift).norm() > 3 * pa.cell && level > 0)
      continue;  // a bad level: let finer ones speak
    e = at_level;
    shift = e.t * pa.cell;
  }
  return judged(a.front(), b.front(), e);
}

PairMotion assess_shift(const LogPicture& a, const LogPicture& b, const Vec2& b_from_a) {
  Estimate e;
  e.t = b_from_a / a.cell;
  e.match = unmatched(a);
  return judged(a, b, iterate(a, b, e, 3, false));
}

}  // namespace hdr::internal
