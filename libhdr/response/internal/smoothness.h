#pragma once
// The smoothness of g, from the data.
#include <Eigen/Core>
#include <array>

namespace hdr {

/// How smooth, and in which coordinate (Knots).
struct SmoothnessChoice {
  double smoothness;
  double shoulder;
  bool prior = false;  ///< of g less the prior
};

/// Cross-validation: g is fitted to two thirds of the points and judged by the residuals of the last third, for each
/// smoothness of a grid, with a shoulder and without. Of those within one standard error of the best, or within
/// 15 % of its mean square, the smoothest wins [Hastie09, 7.10]: held-out points cannot see an error of the curve that
/// is periodic in the step of a uniform bracket, and a little systematic error in dark codes would otherwise buy such
/// waves. An empty channel does not vote.
///
/// `priors` (at the knots without a shoulder; empty: none) enter as one more way to be smooth.
SmoothnessChoice choose_smoothness(int bits, const std::array<Eigen::MatrixXd, 3>& codes,
                                   const Eigen::VectorXd& ln_exposure,
                                   const std::array<Eigen::VectorXd, 3>& priors = {});

}  // namespace hdr
