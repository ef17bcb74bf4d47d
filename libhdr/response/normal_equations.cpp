#include "libhdr/response/internal/normal_equations.h"

#include <cmath>
#include <vector>

#include "libhdr/response/internal/debevec_malik.h"
#include "libhdr/response/internal/solve_definite.h"

namespace hdr {

NormalEquations::NormalEquations(const Knots& knots, const CodeWeights& weights, const Eigen::MatrixXd& codes,
                                 const Eigen::VectorXd& ln_exposure)
    : knots_(knots),
      matrix_(Eigen::MatrixXd::Zero(knots.count(), knots.count())),
      right_(Eigen::VectorXd::Zero(knots.count())) {
  for (Eigen::Index i = 0; i < codes.rows(); ++i) add_point(weights, codes, i, ln_exposure);
}

/// The rows w_j (a_j'g - ln E - ln H_j), with a_j the interpolation between two knots, lose ln E to their weighted
/// mean. What is left is sum w^2 a a' - (sum w^2 a)(sum w^2 a)' / sum w^2, and likewise on the right with ln H in place
/// of one a.
void NormalEquations::add_point(const CodeWeights& weights, const Eigen::MatrixXd& codes, Eigen::Index i,
                                const Eigen::VectorXd& ln_exposure) {
  struct Entry {
    int knot;
    double value;
  };
  std::vector<Entry> sum;
  double total = 0, sum_ln_exposure = 0;
  for (Eigen::Index j = 0; j < codes.cols(); ++j) {
    if (std::isnan(codes(i, j))) continue;
    const Knots::Place place = knots_.place(codes(i, j));
    const double w = weights.at(codes(i, j)), square = w * w;
    const Entry a[2] = {{place.knot, 1 - place.t}, {place.knot + 1, place.t}};
    for (const Entry& p : a) {
      for (const Entry& q : a) matrix_(p.knot, q.knot) += square * p.value * q.value;
      right_[p.knot] += square * p.value * ln_exposure[j];
      sum.push_back({p.knot, square * p.value});
    }
    total += square;
    sum_ln_exposure += square * ln_exposure[j];
  }
  for (const Entry& p : sum) {
    for (const Entry& q : sum) matrix_(p.knot, q.knot) -= p.value * q.value / total;
    right_[p.knot] -= p.value * sum_ln_exposure / total;
  }
}

/// The whole matrix, in which g(middle) = 0 is known.
Eigen::MatrixXd NormalEquations::with_smoothness(double smoothness) const {
  Eigen::MatrixXd matrix = matrix_;
  for (int k = 1; k + 1 < knots_.count(); ++k) {
    const std::array<double, 3> c = smoothness_coefficients(knots_, k, smoothness);
    for (int p = 0; p < 3; ++p) {
      for (int q = 0; q < 3; ++q) {
        matrix(k - 1 + p, k - 1 + q) += c[static_cast<std::size_t>(p)] * c[static_cast<std::size_t>(q)];
      }
    }
  }
  const int middle = knots_.middle();
  matrix.row(middle).setZero();
  matrix.col(middle).setZero();
  matrix(middle, middle) = 1;
  return matrix;
}

Eigen::VectorXd NormalEquations::solve(double smoothness, const Eigen::VectorXd& prior) const {
  Eigen::VectorXd right = right_;
  for (int k = 1; prior.size() > 0 && k + 1 < knots_.count(); ++k) {
    const std::array<double, 3> c = smoothness_coefficients(knots_, k, smoothness);
    const double expected = c[0] * prior[k - 1] + c[1] * prior[k] + c[2] * prior[k + 1];
    for (int p = 0; p < 3; ++p) right[k - 1 + p] += c[static_cast<std::size_t>(p)] * expected;
  }
  right[knots_.middle()] = 0;
  return solve_definite(with_smoothness(smoothness), right);
}

Eigen::VectorXd NormalEquations::deviation(double smoothness, double rms) const {
  const Eigen::MatrixXd inverse =
      solve_definite(with_smoothness(smoothness), Eigen::MatrixXd::Identity(knots_.count(), knots_.count()));
  Eigen::VectorXd deviation = rms * inverse.diagonal().cwiseMax(0).cwiseSqrt();
  deviation[knots_.middle()] = 0;
  return deviation;
}

}  // namespace hdr
