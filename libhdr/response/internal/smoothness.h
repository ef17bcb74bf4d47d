#pragma once
// The smoothness of g, from the data.
#include <Eigen/Core>
#include <array>

#include "libhdr/response/internal/code_weights.h"

namespace hdr {

/// How smooth, and in which coordinate (Knots).
struct SmoothnessChoice {
  double smoothness;
  double shoulder;
  bool prior = false;  ///< of g less the prior
};

/// Cross-validation: g is fitted to two thirds of the points and judged by the residuals of the last third, for each
/// smoothness of a grid, with a shoulder and without. Of those within one standard error of the best the smoothest
/// wins [Hastie09, 7.10]. Held-out points cannot see an error of the curve that is periodic in the step of a uniform
/// bracket (ambiguous_step), and a little systematic error in dark codes would buy such waves: there a smoothness below
/// 1 is not theirs to choose. An empty channel does not vote. `weights`: of the channels' codes.
///
/// `priors` (at the knots without a shoulder; empty: none) enter as one more way to be smooth.
SmoothnessChoice choose_smoothness(int bits, const std::array<CodeWeights, 3>& weights,
                                   const std::array<Eigen::MatrixXd, 3>& codes, const Eigen::VectorXd& ln_exposure,
                                   const std::array<Eigen::VectorXd, 3>& priors = {});

}  // namespace hdr
