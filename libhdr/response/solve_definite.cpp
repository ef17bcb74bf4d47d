#include "libhdr/response/internal/solve_definite.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>

namespace hdr {

Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  const Eigen::LLT<Eigen::MatrixXd> factors(matrix);
  if (factors.info() == Eigen::Success) {
    Eigen::MatrixXd solution = factors.solve(right);
    if (solution.allFinite()) return solution;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  const Eigen::VectorXd& values = eigen.eigenvalues();
  const double least =
      values.cwiseAbs().maxCoeff() * static_cast<double>(matrix.rows()) * std::numeric_limits<double>::epsilon();
  return eigen.eigenvectors() *
         (values.cwiseMax(least).cwiseInverse().asDiagonal() * (eigen.eigenvectors().transpose() * right));
}

}  // namespace hdr
