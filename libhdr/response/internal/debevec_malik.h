#pragma once
// [Debevec97] eq. 3 for one channel.
#include <Eigen/Core>
#include <array>
#include <optional>

#include "libhdr/response/internal/code_weights.h"
#include "libhdr/response/internal/knots.h"

namespace hdr {

struct CurveFit {
  Eigen::VectorXd g;  ///< at the knots, 0 at the middle one
  double rms = 0;     ///< weighted rms of g(Z_ij) - ln E_i - ln H_j
  bool converged = false;
};

/// Minimises, over g and ln E,
///   sum_ij { w(Z_ij) [g(Z_ij) - ln E_i - ln H_j] }^2 + smoothness sum_k [h(Z_k) g''(u_k)]^2 du_k,   g(middle) = 0,
/// where w are the `weights` and h is the hat, whatever w is: how smooth g is does not depend on the noise.
/// With `outlier_scale` the squares of the first sum give way to Cauchy's loss of that scale, and what moved or was
/// misregistered counts little. `codes(i, j)` is NaN where shot j does not show point i. With a `prior` (g at
/// the knots, curve_prior.h) it is (g - prior)'' that is smooth.
CurveFit fit_curve(const Knots& knots, const CodeWeights& weights, const Eigen::MatrixXd& codes,
                   const Eigen::VectorXd& ln_exposure, double smoothness, std::optional<double> outlier_scale = {},
                   const Eigen::VectorXd& prior = {});

/// Coefficients of g[k-1], g[k], g[k+1] in the residual of the smoothness at knot k.
std::array<double, 3> smoothness_coefficients(const Knots& knots, int k, double smoothness);

/// w(Z_ij) [g(Z_ij) - ln E_i - ln H_j], with ln E_i the weighted mean over the shots; NaN where codes are.
Eigen::MatrixXd weighted_residuals(const Knots& knots, const CodeWeights& weights, const Eigen::VectorXd& g,
                                   const Eigen::MatrixXd& codes, const Eigen::VectorXd& ln_exposure);

}  // namespace hdr
