#include "libhdr/response/internal/refine_times.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "libhdr/response/internal/debevec_malik.h"

namespace hdr {
namespace {

constexpr double kShutterDeviation = 0.03;            ///< prior of d_j
constexpr double kMostCorrection = 0.5 * 0.34657359;  ///< half of half a stop, ln
constexpr double kOutlier = 4;                        ///< Cauchy's loss sets in here, in units of the noise

/// The marks of shutter dials and of EXIF; below 0.3 s as 1/n.
constexpr double kLongTimes[] = {0.3, 0.4, 0.5, 0.6, 0.8, 1,  1.3, 1.6, 2,  2.5, 3.2,
                                 4,   5,   6,   8,   10,  13, 15,  20,  25, 30,  60};
constexpr double kInverseTimes[] = {4,    5,     6,     8,     10,    13,    15,    20,    25,    30,   40,
                                    50,   60,    80,    100,   125,   160,   200,   250,   320,   400,  500,
                                    640,  800,   1000,  1250,  1600,  2000,  2500,  3200,  4000,  5000, 6400,
                                    8000, 10000, 12800, 16000, 20000, 25600, 32000, 40000, 51200, 64000};

bool is_label(double seconds) {
  constexpr double kPrinted = 1e-3;  // EXIF's rationals and times typed with four digits
  const auto near = [&](double label) { return std::abs(seconds / label - 1) < kPrinted; };
  return std::any_of(std::begin(kLongTimes), std::end(kLongTimes), near) ||
         std::any_of(std::begin(kInverseTimes), std::end(kInverseTimes), [&](double n) { return near(1 / n); });
}

/// w [g(Z_ij) - ln E_i - ln H_j - d_j] / noise. Parameters: ln E_i, g[k], g[k + 1], d_j.
struct DataTerm {
  double weight, t, ln_exposure;
  template <class T>
  bool operator()(const T* ln_radiance, const T* below, const T* above, const T* correction, T* residual) const {
    residual[0] = weight * ((1 - t) * *below + t * *above - *ln_radiance - ln_exposure - *correction);
    return true;
  }
};

struct SmoothnessTerm {
  std::array<double, 3> c;
  template <class T>
  bool operator()(const T* below, const T* here, const T* above, T* residual) const {
    residual[0] = c[0] * *below + c[1] * *here + c[2] * *above;
    return true;
  }
};

/// sum_j coefficient_j d_j: zero, or nearly.
class LinearTerm final : public ceres::CostFunction {
 public:
  explicit LinearTerm(Eigen::VectorXd coefficients) : coefficients_(std::move(coefficients)) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->assign(static_cast<std::size_t>(coefficients_.size()), 1);
  }
  bool Evaluate(const double* const* p, double* residual, double** jacobians) const override {
    residual[0] = 0;
    for (Eigen::Index j = 0; j < coefficients_.size(); ++j) {
      residual[0] += coefficients_[j] * *p[j];
      if (jacobians != nullptr && jacobians[j] != nullptr) jacobians[j][0] = coefficients_[j];
    }
    return true;
  }

 private:
  Eigen::VectorXd coefficients_;
};

/// All unknowns, at addresses that stay.
struct Unknowns {
  std::array<Eigen::VectorXd, 3> g, ln_radiance;
  Eigen::VectorXd correction;
};

void add_channel(ceres::Problem& problem, const Knots& knots, const Eigen::MatrixXd& codes,
                 const Eigen::VectorXd& ln_exposure, double smoothness, double noise, ceres::LossFunction* loss,
                 std::size_t channel, Unknowns& x) {
  Eigen::VectorXd &g = x.g[channel], &ln_radiance = x.ln_radiance[channel];
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    for (Eigen::Index j = 0; j < codes.cols(); ++j) {
      if (std::isnan(codes(i, j))) continue;
      const Knots::Place place = knots.place(codes(i, j));
      const double weight = hat_weight(codes(i, j), knots.max_code()) / noise;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<DataTerm, 1, 1, 1, 1, 1>(new DataTerm{weight, place.t, ln_exposure[j]}), loss,
          &ln_radiance[i], &g[place.knot], &g[place.knot + 1], &x.correction[j]);
    }
  }
  for (int k = 1; k + 1 < knots.count(); ++k) {
    std::array<double, 3> c = smoothness_coefficients(knots, k, smoothness);
    for (double& each : c) each /= noise;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SmoothnessTerm, 1, 1, 1, 1>(new SmoothnessTerm{c}),
                             nullptr, &g[k - 1], &g[k], &g[k + 1]);
  }
  problem.SetParameterBlockConstant(&g[knots.middle()]);
}

/// The start: the curves for the times as given, and the ln E_i that go with them.
Unknowns first_guess(const Knots& knots, const Observations& seen, double smoothness) {
  Unknowns x;
  x.correction = Eigen::VectorXd::Zero(seen.ln_exposure.size());
  const CodeWeights hat = CodeWeights::hat(seen.bits);
  for (std::size_t c = 0; c < 3; ++c) {
    const Eigen::MatrixXd& codes = seen.codes[c];
    if (codes.rows() == 0) continue;
    x.g[c] = fit_curve(knots, hat, codes, seen.ln_exposure, smoothness, 0.1).g;
    x.ln_radiance[c] = Eigen::VectorXd::Zero(codes.rows());
    for (Eigen::Index i = 0; i < codes.rows(); ++i) {
      int count = 0;
      for (Eigen::Index j = 0; j < codes.cols(); ++j) {
        if (std::isnan(codes(i, j))) continue;
        const Knots::Place place = knots.place(codes(i, j));
        x.ln_radiance[c][i] +=
            (1 - place.t) * x.g[c][place.knot] + place.t * x.g[c][place.knot + 1] - seen.ln_exposure[j];
        ++count;
      }
      x.ln_radiance[c][i] /= std::max(1, count);
    }
  }
  return x;
}

/// Points that each shot shares with another one.
Eigen::VectorXd points_of_shots(const Observations& seen) {
  Eigen::VectorXd points = Eigen::VectorXd::Zero(seen.ln_exposure.size());
  for (const Eigen::MatrixXd& codes : seen.codes) {
    for (Eigen::Index j = 0; j < (codes.rows() > 0 ? codes.cols() : 0); ++j) {
      points[j] += static_cast<double>(codes.col(j).array().isFinite().count());
    }
  }
  return points;
}

/// Mean and slope count each shot by what is known of it: a shot that is clipped nearly everywhere could otherwise pay,
/// at the price of its own prior alone, for tilting all others.
void add_gauge(ceres::Problem& problem, const Observations& seen, Eigen::VectorXd& correction) {
  std::vector<double*> all;
  for (Eigen::Index j = 0; j < correction.size(); ++j) {
    all.push_back(&correction[j]);
    problem.AddResidualBlock(new LinearTerm(Eigen::VectorXd::Constant(1, 1 / kShutterDeviation)), nullptr, all.back());
    problem.SetParameterLowerBound(all.back(), 0, -kMostCorrection);
    problem.SetParameterUpperBound(all.back(), 0, kMostCorrection);
  }
  // Far stiffer than any prior, so that they are equalities in all but name.
  constexpr double kStiffness = 1e4 / kShutterDeviation;
  const Eigen::VectorXd points = points_of_shots(seen), share = points / std::max(1.0, points.sum());
  const Eigen::VectorXd slope = share.array() * (seen.ln_exposure.array() - share.dot(seen.ln_exposure));
  problem.AddResidualBlock(new LinearTerm(share.normalized() * kStiffness), nullptr, all);
  problem.AddResidualBlock(new LinearTerm(slope.normalized() * kStiffness), nullptr, all);
}

ceres::Solver::Options solver_options(const Unknowns& x) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t c = 0; c < 3; ++c) {
    for (const double& e : x.ln_radiance[c].reshaped()) ordering->AddElementToGroup(const_cast<double*>(&e), 0);
    for (const double& g : x.g[c].reshaped()) ordering->AddElementToGroup(const_cast<double*>(&g), 1);
  }
  for (const double& d : x.correction.reshaped()) ordering->AddElementToGroup(const_cast<double*>(&d), 1);
  options.linear_solver_ordering = std::move(ordering);
  options.initial_trust_region_radius = 1e8;
  options.max_num_iterations = 30;
  options.function_tolerance = 1e-5;
  options.num_threads = 1;  // sums in a fixed order
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

Eigen::VectorXd snapped_ln_times(const Eigen::VectorXd& seconds) {
  Eigen::VectorXd ln = seconds.array().log();
  if (!std::all_of(seconds.begin(), seconds.end(), is_label)) return ln;
  const double third = std::log(2.0) / 3;
  for (double& each : ln) each = third * std::round(each / third);
  return ln;
}

RefinedTimes refine_times(const Knots& knots, const Observations& seen, double smoothness, double noise) {
  Unknowns x = first_guess(knots, seen, smoothness);
  ceres::CauchyLoss loss(kOutlier);
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() > 0) {
      add_channel(problem, knots, seen.codes[c], seen.ln_exposure, smoothness, noise, &loss, c, x);
    }
  }
  add_gauge(problem, seen, x.correction);
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(x), &problem, &summary);

  RefinedTimes refined;
  refined.correction = x.correction;
  refined.converged = summary.termination_type == ceres::CONVERGENCE;
  const Eigen::VectorXd ln_exposure = seen.ln_exposure + x.correction;
  double squares = 0, count = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() == 0) continue;
    const Eigen::MatrixXd residuals =
        weighted_residuals(knots, CodeWeights::hat(seen.bits), x.g[c], seen.codes[c], ln_exposure);
    for (const double r : residuals.reshaped()) {
      if (std::isnan(r)) continue;
      squares += std::min(r * r, 25 * noise * noise);  // what moved says nothing of the times
      ++count;
    }
  }
  refined.count = count;
  refined.prior = x.correction.squaredNorm() / (kShutterDeviation * kShutterDeviation);
  refined.rms = std::sqrt(squares / std::max(1.0, count));
  return refined;
}

}  // namespace hdr
