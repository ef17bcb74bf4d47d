// [Mitsunaga99] Radiometric Self Calibration.
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/response/calibrate.h"
#include "libhdr/response/internal/bracket_check.h"
#include "libhdr/response/internal/monotone.h"
#include "libhdr/response/internal/solve_definite.h"

namespace hdr {
namespace {

constexpr int kPoints = 1200;  ///< a channel
constexpr int kHighestOrder = 10;
constexpr double kTolerance = 1.1;    ///< of the held-out error: what a higher order must gain to be believed
constexpr int kFolds = 3;             ///< the last third is held out
constexpr double kMoved = 0.02;       ///< of saturation: where Cauchy's loss begins to give way to what moved
constexpr int kMostIterations = 30;   ///< of the alternation with the ratios
constexpr double kConverged = 1e-4;   ///< change of f^-1 in one of them, of saturation
constexpr double kFurthest = 0.1733;  ///< a quarter of a stop, ln: no shutter errs more

/// Two neighbouring shots of one point: f^-1(M_q) = R f^-1(M_q+1), R the ratio of the shots' exposures.
struct Pair {
  double shorter, longer;  ///< M_q and M_q+1, codes as shares of the largest
  Eigen::Index shot;       ///< q
  Eigen::Index point;      ///< p
};

using Pairs = std::vector<Pair>;

/// The polynomial f^-1 in Chebyshev's basis on [0, 1]: the published space sum c_n M^n, without the cancellation of
/// high powers. T_n(1) = 1 for each n, so that f^-1(1) = 1 is a_0 = 1 - sum of the others, which are the unknowns.
class Polynomial {
 public:
  explicit Polynomial(int order) : a(Eigen::VectorXd::Zero(order)) { a[0] = 0.5; }  // f^-1(M) = M

  /// T_n(2 M - 1) - 1 for n = 1 .. order: how f^-1(M) moves with a_n.
  static Eigen::VectorXd basis(double value, int order) {
    Eigen::VectorXd basis(order);
    double before = 1, here = 2 * value - 1;
    for (int n = 0; n < order; ++n) {
      basis[n] = here - 1;
      const double next = 2 * (2 * value - 1) * here - before;
      before = here;
      here = next;
    }
    return basis;
  }
  double operator()(double value) const { return 1 + a.dot(basis(value, order())); }
  int order() const { return static_cast<int>(a.size()); }

  Eigen::VectorXd a;
};

/// f^-1(M_q) - R f^-1(M_q+1) = (1 - R) + sum_n a_n (b_n(M_q) - R b_n(M_q+1))
class PairTerm final : public ceres::CostFunction {
 public:
  PairTerm(const Pair& pair, double ratio, int order)
      : constant_(1 - ratio),
        row_(Polynomial::basis(pair.shorter, order) - ratio * Polynomial::basis(pair.longer, order)) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(order);
  }

  bool Evaluate(const double* const* p, double* residual, double** jacobians) const override {
    residual[0] = constant_ + row_.dot(Eigen::Map<const Eigen::VectorXd>(p[0], row_.size()));
    if (jacobians != nullptr && jacobians[0] != nullptr) std::copy(row_.begin(), row_.end(), jacobians[0]);
    return true;
  }
  const Eigen::VectorXd& row() const { return row_; }

 private:
  double constant_;
  Eigen::VectorXd row_;
};

Pairs pairs_of_channel(const Observations& seen, std::size_t channel) {
  const Eigen::MatrixXd& codes = seen.codes[channel];
  const double black = seen.black_level[channel], white = std::ldexp(1.0, seen.bits) - 1;
  Pairs pairs;
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    for (Eigen::Index j = 0; j + 1 < codes.cols(); ++j) {
      if (std::isnan(codes(i, j)) || std::isnan(codes(i, j + 1))) continue;
      pairs.push_back({(codes(i, j) - black) / (white - black), (codes(i, j + 1) - black) / (white - black), j, i});
    }
  }
  return pairs;
}

struct Fit {
  Polynomial inverse;
  Eigen::MatrixXd covariance;  ///< of a
  bool converged = false;
};

double ratio(const Eigen::VectorXd& ln_exposure, Eigen::Index shot) {
  return std::exp(ln_exposure[shot] - ln_exposure[shot + 1]);
}

/// Covariance of a: the information of the pairs, each trusted as the loss does, times their variance.
Eigen::MatrixXd covariance(const Polynomial& inverse, const Pairs& pairs, const Eigen::VectorXd& ln_exposure) {
  const int order = inverse.order();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(order, order);
  double squares = 0, count = 0;
  for (const Pair& pair : pairs) {
    const PairTerm term(pair, ratio(ln_exposure, pair.shot), order);
    double r = 0;
    const double* a = inverse.a.data();
    term.Evaluate(&a, &r, nullptr);
    const double trust = 1 / (1 + r * r / (kMoved * kMoved));
    information += trust * term.row() * term.row().transpose();
    squares += trust * r * r;
    count += trust;
  }
  return solve_definite(information, Eigen::MatrixXd::Identity(order, order)) *
         (squares / std::max(1.0, count - order));
}

Fit fit_polynomial(const Pairs& pairs, const Eigen::VectorXd& ln_exposure, int order) {
  Fit fit{Polynomial(order), {}, false};
  ceres::CauchyLoss cauchy(kMoved);
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  for (const Pair& pair : pairs) {
    problem.AddResidualBlock(new PairTerm(pair, ratio(ln_exposure, pair.shot), order), &cauchy, fit.inverse.a.data());
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.initial_trust_region_radius = 1e8;  // linear but for the loss: full Gauss-Newton steps
  solver.max_trust_region_radius = 1e16;
  solver.max_num_iterations = 30;
  solver.function_tolerance = 1e-6;
  solver.num_threads = 1;  // sums in a fixed order
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  return fit;
}

/// The mean loss of the pairs that are held out, as a share of their brightness: f^-1(1) = 1 is an exposure that no
/// pair shows, and a high order can shrink all others, and with them the error, by rising steeply there.
double held_out_error(const Pairs& pairs, const Eigen::VectorXd& ln_exposure, int order) {
  Pairs kept, held;
  for (const Pair& pair : pairs) (pair.point % kFolds == kFolds - 1 ? held : kept).push_back(pair);
  if (held.empty()) return 0;
  const Fit fit = fit_polynomial(kept, ln_exposure, order);
  double brightness = 0;
  for (const Pair& pair : held) brightness += fit.inverse(pair.longer) / static_cast<double>(held.size());
  double loss = 0;
  for (const Pair& pair : held) {
    const double r = fit.inverse(pair.shorter) - ratio(ln_exposure, pair.shot) * fit.inverse(pair.longer);
    const double share = r / brightness;
    loss += std::log1p(share * share / (kMoved * kMoved));
  }
  return loss / static_cast<double>(held.size());
}

/// As published each order up to 10 is tried and the error decides; but the error of points that the fit has not seen,
/// since on its own points a higher order never does worse, and the lowest order that does nearly as well as the best:
/// held-out points cannot see waves with the step of a uniform bracket, which high orders have room for.
int choose_order(const std::array<Pairs, 3>& pairs, const Eigen::VectorXd& ln_exposure) {
  std::array<double, 3 * kHighestOrder> errors{};
  for_rows(3 * kHighestOrder, 1, [&](int first, int) {
    const Pairs& channel = pairs[static_cast<std::size_t>(first % 3)];
    if (!channel.empty()) {
      errors[static_cast<std::size_t>(first)] = held_out_error(channel, ln_exposure, first / 3 + 1);
    }
  });
  std::array<double, kHighestOrder> totals{};
  for (std::size_t k = 0; k < errors.size(); ++k) totals[k / 3] += errors[k];
  const double enough = kTolerance * *std::min_element(totals.begin(), totals.end());
  int order = 1;
  while (totals[static_cast<std::size_t>(order) - 1] > enough) ++order;
  return order;
}

std::array<Fit, 3> fit_channels(const std::array<Pairs, 3>& pairs, const Eigen::VectorXd& ln_exposure, int order) {
  std::array<Fit, 3> fits{Fit{Polynomial(order), {}, true}, Fit{Polynomial(order), {}, true},
                          Fit{Polynomial(order), {}, true}};
  for_rows(3, 1, [&](int first, int) {
    const auto c = static_cast<std::size_t>(first);
    if (!pairs[c].empty()) fits[c] = fit_polynomial(pairs[c], ln_exposure, order);
  });
  return fits;
}

/// [Mitsunaga99] The ratio of two shots is the mean of f^-1(M_q) / f^-1(M_q+1); the median here, against what
/// moved. The polynomial cannot tell e_q from e_q^gamma, so that the mean and the slope of the given times are kept.
Eigen::VectorXd refined(const std::array<Pairs, 3>& pairs, const std::array<Fit, 3>& fits, const Eigen::VectorXd& given,
                        const Eigen::VectorXd& current) {
  const Eigen::Index shots = given.size();
  std::vector<std::vector<double>> ratios(static_cast<std::size_t>(shots));
  for (std::size_t c = 0; c < 3; ++c) {
    for (const Pair& pair : pairs[c]) {
      const double above = fits[c].inverse(pair.shorter), below = fits[c].inverse(pair.longer);
      if (above > 0 && below > 0) ratios[static_cast<std::size_t>(pair.shot)].push_back(std::log(below / above));
    }
  }
  Eigen::VectorXd measured(shots);
  measured[0] = 0;
  for (Eigen::Index j = 0; j + 1 < shots; ++j) {
    std::vector<double>& sample = ratios[static_cast<std::size_t>(j)];
    measured[j + 1] = measured[j] + current[j + 1] - current[j];
    if (sample.empty()) continue;
    const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
    std::nth_element(sample.begin(), middle, sample.end());
    measured[j + 1] = measured[j] + *middle;
  }
  Eigen::VectorXd correction = measured - given;
  correction.array() -= correction.mean();
  const Eigen::VectorXd spread = given.array() - given.mean();
  correction -= spread * (spread.dot(correction) / spread.squaredNorm());
  return given + correction.cwiseMax(-kFurthest).cwiseMin(kFurthest);
}

/// Largest change of f^-1 over the codes.
double change(const std::array<Fit, 3>& before, const std::array<Fit, 3>& after) {
  double largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int k = 0; k <= 64; ++k) {
      largest = std::max(largest, std::abs(after[c].inverse(k / 64.0) - before[c].inverse(k / 64.0)));
    }
  }
  return largest;
}

/// exp(g) at every sample of a response, not scaled. Below `lowest`, the darkest code that was seen, and where the
/// polynomial is not positive, exposure falls in proportion to the code.
std::vector<double> exposures(const Polynomial& inverse, int bits, double black, double lowest) {
  Response codes;
  codes.bits = bits;
  const double white = std::ldexp(1.0, bits) - 1;
  const auto value = [&](int level) {
    return std::max(0.0, std::min(codes.code_from_level(level), white) - black) / (white - black);
  };
  const int levels = response_levels(bits);
  std::vector<double> curve(static_cast<std::size_t>(levels));
  int foot = levels - 1;  // the lowest sample from which on the polynomial is trusted
  while (foot > 1 && value(foot - 1) >= (lowest - black) / (white - black) && inverse(value(foot - 1)) > 0) --foot;
  for (int k = foot; k < levels; ++k) curve[static_cast<std::size_t>(k)] = inverse(value(k));
  for (int k = 0; k < foot; ++k) {
    // Code 0 stands for half the exposure of code 1/2 (Response), and so do all codes up to a black level.
    const double share = std::max(0.25 / (white - black), value(k)) / value(foot);
    curve[static_cast<std::size_t>(k)] = curve[static_cast<std::size_t>(foot)] * share;
  }
  make_nondecreasing(curve);
  return curve;
}

std::vector<double> logs_about_the_middle(const std::vector<double>& exposure) {
  std::vector<double> g;
  for (const double e : exposure) g.push_back(std::log(e / exposure[exposure.size() / 2]));
  return g;
}

/// The noise of the fit, and what one order more (or less, at the highest) would change; both about the middle code.
std::vector<double> deviation(const Fit& fit, const std::vector<double>& exposure, const std::vector<double>& g,
                              const std::vector<double>& other) {
  const int order = fit.inverse.order();
  const auto d_ln = [&](std::size_t k) {
    const double value = static_cast<double>(k) / static_cast<double>(exposure.size() - 1);
    return (Polynomial::basis(value, order) / exposure[k]).eval();
  };
  const Eigen::VectorXd middle = d_ln(g.size() / 2);
  std::vector<double> deviation;
  for (std::size_t k = 0; k < g.size(); ++k) {
    const Eigen::VectorXd gradient = d_ln(k) - middle;
    deviation.push_back(std::hypot(std::sqrt(std::max(0.0, gradient.dot(fit.covariance * gradient))), other[k] - g[k]));
  }
  return deviation;
}

/// Sum of squares of g(Z_ij) - ln H_j about each point's mean, and of the weights: exposures, as the objective weighs
/// ln.
Eigen::Vector2d squared_residuals(const Response& response, int channel, const Eigen::MatrixXd& codes,
                                  const Eigen::VectorXd& ln_exposure) {
  Eigen::Vector2d sums = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    double sum = 0, squares = 0, weights = 0;
    for (Eigen::Index j = 0; j < codes.cols(); ++j) {
      if (std::isnan(codes(i, j))) continue;
      const double g = response.ln_exposure(channel, codes(i, j)), w = std::exp(2 * g), r = g - ln_exposure[j];
      sum += w * r;
      squares += w * r * r;
      weights += w;
    }
    sums += Eigen::Vector2d(squares - sum * sum / weights, weights);
  }
  return sums;
}

}  // namespace

Calibration calibrate_mitsunaga_nayar(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                                      const CalibrateOptions& options) {
  check_exposures(bracket);
  Observations seen = sample_points(bracket, ref_from_photo, options.pixels > 0 ? options.pixels : kPoints);
  Calibration result;
  result.warnings = check_coverage(seen, bracket);
  check_brightening(seen, bracket);
  std::array<Pairs, 3> pairs;
  for (std::size_t c = 0; c < 3; ++c) pairs[c] = pairs_of_channel(seen, c);

  const int order = choose_order(pairs, seen.ln_exposure);
  const Eigen::VectorXd given = seen.ln_exposure;
  std::array<Fit, 3> fits = fit_channels(pairs, seen.ln_exposure, order);
  result.converged = true;
  if (options.refine_times) {
    result.converged = false;
    for (int iteration = 0; iteration < kMostIterations && !result.converged; ++iteration) {
      seen.ln_exposure = refined(pairs, fits, given, seen.ln_exposure);
      std::array<Fit, 3> next = fit_channels(pairs, seen.ln_exposure, order);
      result.converged = change(fits, next) < kConverged;
      fits = std::move(next);
    }
  }
  const std::array<Fit, 3> others =
      fit_channels(pairs, seen.ln_exposure, order < kHighestOrder ? order + 1 : order - 1);

  result.response.bits = seen.bits;
  Eigen::Vector2d sums = Eigen::Vector2d::Zero();
  for (std::size_t c = 0; c < 3; ++c) {
    const Eigen::MatrixXd& codes = seen.codes[c];
    if (codes.rows() == 0) continue;
    const double lowest = codes.array().isFinite().select(codes.array(), INFINITY).minCoeff();
    const std::vector<double> curve = exposures(fits[c].inverse, seen.bits, seen.black_level[c], lowest);
    const std::vector<double> other = exposures(others[c].inverse, seen.bits, seen.black_level[c], lowest);
    fits[c].covariance = covariance(fits[c].inverse, pairs[c], seen.ln_exposure);
    result.response.g[c] = logs_about_the_middle(curve);
    result.deviation[c] = deviation(fits[c], curve, result.response.g[c], logs_about_the_middle(other));
    result.converged = result.converged && fits[c].converged;
    result.pixels += static_cast<int>(codes.rows());
  }
  borrow_curves(result.response.g);
  borrow_curves(result.deviation);
  for (int c = 0; c < 3; ++c) {
    sums += squared_residuals(result.response, c, seen.codes[static_cast<std::size_t>(c)], seen.ln_exposure);
  }
  result.rms_log_error = std::sqrt(std::max(0.0, sums[0]) / sums[1]);
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    result.seconds.push_back(bracket.shots[j].exposure.seconds.value_or(0) * std::exp(seen.ln_exposure[k] - given[k]));
  }
  return result;
}

}  // namespace hdr
