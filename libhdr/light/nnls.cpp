#include "libhdr/light/internal/nnls.h"

#include <Eigen/Cholesky>
#include <vector>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

using Index = Eigen::Index;
using Free = std::vector<Index>;  // variables that are above 0

Eigen::MatrixXd part_of(const Eigen::MatrixXd& normal, const Free& free) {
  const auto n = static_cast<Index>(free.size());
  Eigen::MatrixXd part(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      part(i, j) = normal(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]);
  return part;
}

// The unconstrained minimum over the free variables, the others at 0.
Eigen::VectorXd minimum(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right, const Free& free) {
  const auto n = static_cast<Index>(free.size());
  Eigen::VectorXd b(n), z = Eigen::VectorXd::Zero(right.size());
  for (Index i = 0; i < n; ++i) b[i] = right[free[static_cast<std::size_t>(i)]];
  const Eigen::VectorXd solution = part_of(normal, free).ldlt().solve(b);
  for (Index i = 0; i < n; ++i) z[free[static_cast<std::size_t>(i)]] = solution[i];
  return z;
}

// From x towards z as far as nothing falls below 0; what has reached it is free no more. False when z was reached.
bool stopped_on_the_way(Eigen::VectorXd& x, const Eigen::VectorXd& z, Free& free) {
  double share = 1;
  Index at = -1;
  for (const Index k : free) {
    if (z[k] > 0) continue;
    const double here = x[k] / (x[k] - z[k]);
    if (at < 0 || here < share) {
      share = here;
      at = k;
    }
  }
  if (at < 0) {
    x = z;
    return false;
  }
  x += share * (z - x);
  x[at] = 0;
  std::erase_if(free, [&](Index k) {
    if (x[k] > 0) return false;
    x[k] = 0;
    return true;
  });
  return true;
}

}  // namespace

NonNegative non_negative_least_squares(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right) {
  const Index n = right.size();
  HDR_ASSERT(normal.rows() == n && normal.cols() == n);
  NonNegative result{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  // Slopes are compared in units in which each column has length 1.
  const Eigen::VectorXd unit = normal.diagonal().cwiseSqrt().cwiseInverse();
  const double least = 1e-13 * right.cwiseProduct(unit).cwiseAbs().maxCoeff();
  Free free;
  for (Index step = 0; step < 3 * n; ++step) {
    Eigen::VectorXd slope = (right - normal * result.x).cwiseProduct(unit);
    for (const Index k : free) slope[k] = 0;
    Index steepest = 0;
    if (!(slope.maxCoeff(&steepest) > least)) break;
    free.push_back(steepest);
    while (!free.empty() && stopped_on_the_way(result.x, minimum(normal, right, free), free)) {
    }
  }
  if (free.empty()) return result;
  const auto count = static_cast<Index>(free.size());
  const Eigen::MatrixXd inverse = part_of(normal, free).ldlt().solve(Eigen::MatrixXd::Identity(count, count));
  for (Index i = 0; i < count; ++i) result.variance[free[static_cast<std::size_t>(i)]] = inverse(i, i);
  return result;
}

}  // namespace hdr
