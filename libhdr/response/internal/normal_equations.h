#pragma once
// [Debevec97] eq. 3 without a loss function is linear: its normal equations for g, every ln E_i eliminated. Ceres fits
// the curve that is used; these serve where many fits of the same points are compared, and where their inverse is asked
// for.
#include <Eigen/Core>

#include "libhdr/response/internal/code_weights.h"
#include "libhdr/response/internal/knots.h"

namespace hdr {

class NormalEquations {
 public:
  /// Of the points `codes.row(i)`, as fit_curve takes them.
  NormalEquations(const Knots& knots, const CodeWeights& weights, const Eigen::MatrixXd& codes,
                  const Eigen::VectorXd& ln_exposure);

  /// g at the knots, 0 at the middle one. `prior` as fit_curve takes it.
  Eigen::VectorXd solve(double smoothness, const Eigen::VectorXd& prior = {}) const;

  /// Standard deviation of g at each knot when the weighted residuals have the root mean square `rms`; 0 at the middle.
  /// With the smoothness as the prior that it is, codes that no two shots share have large ones.
  Eigen::VectorXd deviation(double smoothness, double rms) const;

 private:
  void add_point(const CodeWeights& weights, const Eigen::MatrixXd& codes, Eigen::Index i,
                 const Eigen::VectorXd& ln_exposure);
  Eigen::MatrixXd with_smoothness(double smoothness) const;

  const Knots& knots_;
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd right_;
};

}  // namespace hdr
