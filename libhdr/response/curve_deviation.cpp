// The doubt of a fitted curve.
#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "libhdr/response/internal/debevec_malik.h"

namespace hdr {
namespace {

/// One point's share of the normal matrix. Its rows w_j (g(Z_j) - ln E) lose ln E to their weighted mean, and what is
/// left is sum_j w_j^2 a_j a_j' - (sum_j w_j^2 a_j)(sum_j w_j^2 a_j)' / sum_j w_j^2, with a_j the interpolation.
void add_point(const Knots& knots, const Eigen::MatrixXd& codes, Eigen::Index i, Eigen::MatrixXd& normal) {
  struct Entry {
    int knot;
    double value;
  };
  std::vector<Entry> sum;
  double total = 0;
  for (Eigen::Index j = 0; j < codes.cols(); ++j) {
    if (std::isnan(codes(i, j))) continue;
    const Knots::Place place = knots.place(codes(i, j));
    const double w = hat_weight(codes(i, j), knots.max_code()), square = w * w;
    const Entry a[2] = {{place.knot, 1 - place.t}, {place.knot + 1, place.t}};
    for (const Entry& p : a) {
      for (const Entry& q : a) normal(p.knot, q.knot) += square * p.value * q.value;
      sum.push_back({p.knot, square * p.value});
    }
    total += square;
  }
  for (const Entry& p : sum) {
    for (const Entry& q : sum) normal(p.knot, q.knot) -= p.value * q.value / total;
  }
}

}  // namespace

Eigen::VectorXd curve_deviation(const Knots& knots, const Eigen::MatrixXd& codes, double smoothness, double rms) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(knots.count(), knots.count());
  for (Eigen::Index i = 0; i < codes.rows(); ++i) add_point(knots, codes, i, normal);
  for (int k = 1; k + 1 < knots.count(); ++k) {
    const std::array<double, 3> c = smoothness_coefficients(knots, k, smoothness);
    for (int p = 0; p < 3; ++p) {
      for (int q = 0; q < 3; ++q) {
        normal(k - 1 + p, k - 1 + q) += c[static_cast<std::size_t>(p)] * c[static_cast<std::size_t>(q)];
      }
    }
  }
  // g(middle) = 0 is known.
  const int middle = knots.middle();
  normal.row(middle).setZero();
  normal.col(middle).setZero();
  normal(middle, middle) = 1;
  const Eigen::MatrixXd inverse =
      normal.selfadjointView<Eigen::Lower>().ldlt().solve(Eigen::MatrixXd::Identity(knots.count(), knots.count()));
  Eigen::VectorXd deviation = rms * inverse.diagonal().cwiseMax(0).cwiseSqrt();
  deviation[middle] = 0;
  return deviation;
}

}  // namespace hdr
