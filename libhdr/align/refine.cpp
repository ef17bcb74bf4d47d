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

/// (J^t W J)^-1, with a trace of regularisation for a constant picture.
Mat4 inverse_hessian(const Linearization& at) {
  Mat4 h = at.hessian;
  h.diagonal() += Vec4::Constant(1e-9 * h.trace() + 1e-12);
  return h.ldlt().solve(Mat4::Identity());
}

/// The sandwich of [White80] with tiles as its independent observations: H^-1 (sum s s^t) H^-1. Honest about noise that
/// neighbours share, moved content and an approximate response alike, since it uses the residuals that are there.
Mat2 covariance_of_shift(const Linearization& at, const Mat4& inverse) {
  Mat4 meat = Mat4::Zero();
  for (const Vec4& s : at.tile_scores) meat += s * s.transpose();
  return (inverse * meat * inverse).topLeftCorner<2, 2>();
}

/// Iterates (t, gain, contrast) or, when `move` is false, the photometric match alone.
Estimate iterate(const LogPicture& a, const LogPicture& b, Estimate e, int iterations, bool move) {
  constexpr double kConverged = 0.003;
  const Vec2 start = e.t;
  for (int k = 0; k <= iterations; ++k) {
    Linearization at = linearize(a, b, e.t, e.match);
    e.enough = at.pixels >= kFewestPixels;
    if (!e.enough) return e;
    e.median = at.median_magnitude();
    const Mat4 inverse = inverse_hessian(at);
    e.covariance = covariance_of_shift(at, inverse);
    if (k == iterations) break;
    // Solve H d = -J^t W r, and keep each step within the reach of the linearisation.
    Vec4 d = -(inverse * at.score);
    if (!move) {
      const Mat2 h = at.hessian.bottomRightCorner<2, 2>() + 1e-12 * Mat2::Identity();
      d << 0, 0, -h.ldlt().solve(at.score.tail<2>());
    }
    Vec2 step = d.head<2>();
    if (step.norm() > 1.5) step *= 1.5 / step.norm();
    const double mean = at.sum_a / static_cast<double>(at.pixels);
    const bool settled = step.norm() < kConverged && std::isfinite(e.match.scale);
    e.t += step;
    e.match.contrast += d[3];
    e.match.gain += d[2] + e.match.contrast * (mean - e.match.mean);
    e.match.mean = mean;
    e.match.scale = std::max(e.median / kMedianOfNormal, 1e-3);
    if (settled) break;
    if ((e.t - start).norm() > 4) break;  // lost; the caller's checks decide
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
  return judged(a, b, iterate(a, b, e, 3, false));
}

}  // namespace hdr::internal
