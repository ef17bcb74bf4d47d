// [Debevec97] Recovering High Dynamic Range Radiance Maps from Photographs, eq. 3.
#include "libhdr/response/internal/debevec_malik.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hdr {
namespace {

/// w(Z_ij) [g(Z_ij) - ln E_i - ln H_j], g interpolated between two knots. Parameters: ln E_i, g[k], g[k + 1].
class DataTerm final : public ceres::SizedCostFunction<1, 1, 1, 1> {
 public:
  DataTerm(double weight, double t, double ln_exposure) : weight_(weight), t_(t), ln_exposure_(ln_exposure) {}

  bool Evaluate(const double* const* p, double* residual, double** jacobians) const override {
    residual[0] = weight_ * ((1 - t_) * p[1][0] + t_ * p[2][0] - p[0][0] - ln_exposure_);
    if (jacobians != nullptr) {
      if (jacobians[0] != nullptr) jacobians[0][0] = -weight_;
      if (jacobians[1] != nullptr) jacobians[1][0] = weight_ * (1 - t_);
      if (jacobians[2] != nullptr) jacobians[2][0] = weight_ * t_;
    }
    return true;
  }

 private:
  double weight_, t_, ln_exposure_;
};

/// factor (g''(u_k) - expected) from three neighbouring knots.
class SmoothnessTerm final : public ceres::SizedCostFunction<1, 1, 1, 1> {
 public:
  SmoothnessTerm(const std::array<double, 3>& coefficients, double expected)
      : coefficient_{coefficients[0], coefficients[1], coefficients[2]}, expected_(expected) {}

  bool Evaluate(const double* const* p, double* residual, double** jacobians) const override {
    residual[0] = -expected_;
    for (int k = 0; k < 3; ++k) {
      residual[0] += coefficient_[k] * p[k][0];
      if (jacobians != nullptr && jacobians[k] != nullptr) jacobians[k][0] = coefficient_[k];
    }
    return true;
  }

 private:
  double coefficient_[3];
  double expected_;
};

void add_smoothness(ceres::Problem& problem, const Knots& knots, double smoothness, const Eigen::VectorXd& prior,
                    Eigen::VectorXd& g) {
  for (int k = 1; k + 1 < knots.count(); ++k) {
    const std::array<double, 3> c = smoothness_coefficients(knots, k, smoothness);
    const double expected = prior.size() == 0 ? 0 : c[0] * prior[k - 1] + c[1] * prior[k] + c[2] * prior[k + 1];
    problem.AddResidualBlock(new SmoothnessTerm(c, expected), nullptr, &g[k - 1], &g[k], &g[k + 1]);
  }
}

ceres::Solver::Options solver_options(const Eigen::VectorXd& ln_radiance, const Eigen::VectorXd& g) {
  ceres::Solver::Options options;
  // Each ln E_i meets only g: the Schur complement eliminates all of them and leaves a system as large as g.
  options.linear_solver_type = ceres::DENSE_SCHUR;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (Eigen::Index i = 0; i < ln_radiance.size(); ++i) {
    ordering->AddElementToGroup(const_cast<double*>(&ln_radiance[i]), 0);
  }
  for (Eigen::Index k = 0; k < g.size(); ++k) ordering->AddElementToGroup(const_cast<double*>(&g[k]), 1);
  options.linear_solver_ordering = std::move(ordering);
  options.initial_trust_region_radius = 1e8;  // linear but for the loss: full Gauss-Newton steps
  options.max_trust_region_radius = 1e16;
  options.jacobi_scaling = false;
  options.max_num_iterations = 30;
  options.function_tolerance = 1e-5;
  options.num_threads = 1;  // sums in a fixed order
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

std::array<double, 3> smoothness_coefficients(const Knots& knots, int k, double smoothness) {
  const double left = knots.u(k) - knots.u(k - 1), right = knots.u(k + 1) - knots.u(k);
  const double du = 0.5 * (left + right);
  const double factor = std::sqrt(smoothness * du) * hat_weight(knots.code(k), knots.max_code()) / du;
  return {factor / left, -factor * (1 / left + 1 / right), factor / right};
}

CurveFit fit_curve(const Knots& knots, const CodeWeights& weights, const Eigen::MatrixXd& codes,
                   const Eigen::VectorXd& ln_exposure, double smoothness, std::optional<double> outlier_scale,
                   const Eigen::VectorXd& prior) {
  CurveFit fit;
  // Start from a gamma of 2.2, which most photographs resemble.
  fit.g.resize(knots.count());
  for (int k = 0; k < knots.count(); ++k) fit.g[k] = 2.2 * (knots.u(k) - knots.u(knots.middle()));
  Eigen::VectorXd ln_radiance = Eigen::VectorXd::Zero(codes.rows());

  ceres::CauchyLoss cauchy(outlier_scale.value_or(1));
  ceres::LossFunction* loss = outlier_scale ? &cauchy : nullptr;
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    int seen = 0;
    for (Eigen::Index j = 0; j < codes.cols(); ++j) {
      if (std::isnan(codes(i, j))) continue;
      const Knots::Place place = knots.place(codes(i, j));
      ln_radiance[i] += (1 - place.t) * fit.g[place.knot] + place.t * fit.g[place.knot + 1] - ln_exposure[j];
      ++seen;
      problem.AddResidualBlock(new DataTerm(weights.at(codes(i, j)), place.t, ln_exposure[j]), loss, &ln_radiance[i],
                               &fit.g[place.knot], &fit.g[place.knot + 1]);
    }
    ln_radiance[i] /= std::max(1, seen);
  }
  add_smoothness(problem, knots, smoothness, prior, fit.g);
  problem.SetParameterBlockConstant(&fit.g[knots.middle()]);

  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(ln_radiance, fit.g), &problem, &summary);
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  const Eigen::MatrixXd residuals = weighted_residuals(knots, weights, fit.g, codes, ln_exposure);
  const auto seen = residuals.array().isFinite();
  fit.rms = std::sqrt(seen.select(residuals.array().square(), 0).sum() /
                      std::max<double>(1, static_cast<double>(seen.count())));
  return fit;
}

Eigen::MatrixXd weighted_residuals(const Knots& knots, const CodeWeights& weights, const Eigen::VectorXd& g,
                                   const Eigen::MatrixXd& codes, const Eigen::VectorXd& ln_exposure) {
  Eigen::MatrixXd residuals = codes;
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    // ln E_i that minimises the row: the mean of g(Z_ij) - ln H_j with weights w^2.
    double sum = 0, squares = 0;
    for (Eigen::Index j = 0; j < codes.cols(); ++j) {
      if (std::isnan(codes(i, j))) continue;
      const Knots::Place place = knots.place(codes(i, j));
      const double w = weights.at(codes(i, j));
      residuals(i, j) = (1 - place.t) * g[place.knot] + place.t * g[place.knot + 1] - ln_exposure[j];
      sum += w * w * residuals(i, j);
      squares += w * w;
    }
    for (Eigen::Index j = 0; j < codes.cols(); ++j) {
      if (!std::isnan(codes(i, j))) residuals(i, j) = weights.at(codes(i, j)) * (residuals(i, j) - sum / squares);
    }
  }
  return residuals;
}

}  // namespace hdr
