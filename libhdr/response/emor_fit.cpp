// The member of the family of [Grossberg04] that explains a bracket.
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/response/internal/emor.h"
#include "libhdr/response/internal/knots.h"

namespace hdr {
namespace {

constexpr int kPoints = 600;           ///< a channel: seven unknowns need no more
constexpr int kPilot = 3;              ///< components of the fit that weighs the codes
constexpr int kFolds = 3;              ///< the last third is held out
constexpr double kTolerance = 1.1;     ///< of the held-out mean square: what more components must gain to be believed
constexpr double kGrain = 1.0 / 1023;  ///< the distance of the published samples, as a share of saturation
/// What the family cannot tell with any of these numbers of components, as a share of the largest code: three
/// quarters of a code of 8 bits. Fitted to linear, sRGB, gamma and film curves it is wrong by about that.
constexpr double kFamilyError = 0.003;
constexpr double kCodeNoise = 0.6;    ///< standard deviation of a small window's mean, in 8-bit codes
constexpr double kLeastNoise = 0.01;  ///< ln: the light itself flickers, and shutters err
constexpr double kOutlier = 3;        ///< standard deviations at which Cauchy's loss begins to give way
constexpr int kNeighbourhoods = 32;   ///< of codes, in which the misfit is averaged
constexpr int kSlopes = 64;           ///< places at which the curve is asked to rise
constexpr double kFall = 0.01;        ///< a fall of the curve per unit of x that weighs as much as one bad code

/// How far c_n strays from 0 in cameras: generous for the named curves (linear 6.5, film -2.9; sRGB -1.1 in c_2), and
/// falling with n as the variances of principal components do. It decides only where the points do not.
double prior_deviation(int n) {
  return 4.0 / (n * n);
}

/// A point of the scene in one channel: where its codes stand among the knots, and how much each is worth.
struct Point {
  struct Sight {
    Knots::Place place;
    double ln_exposure, weight;
  };
  std::vector<Sight> sights;
};

struct Scale {
  double max_code, black;
  double value(double code) const {
    const double least = 0.25;  // of a code: what code 0 stands for
    return std::max(least, code - black) / (max_code - black);
  }
};

/// g and its gradient at every knot, made anew for each set of coefficients that the solver tries.
class Table final : public ceres::EvaluationCallback {
 public:
  Eigen::VectorXd g;
  Eigen::MatrixXd gradient;  ///< knots x coefficients

  Table(const Knots& knots, const Scale& scale, const Eigen::VectorXd& coefficients)
      : g(knots.count()),
        gradient(knots.count(), coefficients.size()),
        knots_(knots),
        scale_(scale),
        coefficients_(coefficients) {
    PrepareForEvaluation(true, true);
  }

  void PrepareForEvaluation(bool with_gradient, bool new_point) override {
    if (new_point) fresh_gradient_ = false;
    if (!new_point && (fresh_gradient_ || !with_gradient)) return;
    const EmorCurve curve(coefficients_);
    for (int k = 0; k < knots_.count(); ++k) {
      g[k] = curve.ln_exposure(scale_.value(knots_.code(k)));
      if (with_gradient) gradient.row(k) = curve.gradient(g[k]);
    }
    fresh_gradient_ = with_gradient;
  }

 private:
  const Knots& knots_;
  Scale scale_;
  const Eigen::VectorXd& coefficients_;
  bool fresh_gradient_ = false;
};

/// w_ij [g(Z_ij) - ln H_j - ln E_i] with ln E_i the weighted mean over the shots, which minimises the sum of squares.
class PointTerm final : public ceres::CostFunction {
 public:
  PointTerm(const Point& point, const Table& table) : point_(point), table_(table) {
    set_num_residuals(static_cast<int>(point.sights.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(table.gradient.cols()));
  }

  bool Evaluate(const double* const*, double* residuals, double** jacobians) const override {
    const auto count = static_cast<Eigen::Index>(point_.sights.size());
    double sum = 0, weights = 0;
    for (Eigen::Index j = 0; j < count; ++j) {
      const Point::Sight& s = point_.sights[static_cast<std::size_t>(j)];
      residuals[j] = (1 - s.place.t) * table_.g[s.place.knot] + s.place.t * table_.g[s.place.knot + 1] - s.ln_exposure;
      sum += s.weight * s.weight * residuals[j];
      weights += s.weight * s.weight;
    }
    for (Eigen::Index j = 0; j < count; ++j) {
      residuals[j] = point_.sights[static_cast<std::size_t>(j)].weight * (residuals[j] - sum / weights);
    }
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> rows(jacobians[0], count,
                                                                                            table_.gradient.cols());
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(rows.cols());
    for (Eigen::Index j = 0; j < count; ++j) {
      const Point::Sight& s = point_.sights[static_cast<std::size_t>(j)];
      rows.row(j) =
          (1 - s.place.t) * table_.gradient.row(s.place.knot) + s.place.t * table_.gradient.row(s.place.knot + 1);
      mean += s.weight * s.weight / weights * rows.row(j);
    }
    for (Eigen::Index j = 0; j < count; ++j) {
      rows.row(j) = point_.sights[static_cast<std::size_t>(j)].weight * (rows.row(j) - mean);
    }
    return true;
  }

 private:
  const Point& point_;
  const Table& table_;
};

/// A response of a camera rises: each fall of the sum is a misfit. And c_n keeps to its prior.
class PriorTerm final : public ceres::CostFunction {
 public:
  explicit PriorTerm(int components) {
    set_num_residuals(kSlopes + components);
    mutable_parameter_block_sizes()->push_back(components);
  }

  bool Evaluate(const double* const* p, double* residuals, double** jacobians) const override {
    static const Eigen::MatrixXd kSlopesOfComponents = EmorCurve::slopes_of_components(kSlopes);
    const int components = parameter_block_sizes()[0];
    const Eigen::Map<const Eigen::VectorXd> c(p[0], components);
    Eigen::Map<Eigen::VectorXd>(residuals, kSlopes) = EmorCurve(c).slopes(kSlopes).cwiseMin(0) / kFall;
    for (int n = 0; n < components; ++n) residuals[kSlopes + n] = c[n] / prior_deviation(n + 1);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<Eigen::MatrixXd, 0, Eigen::Stride<1, Eigen::Dynamic>> rows(
        jacobians[0], num_residuals(), components, Eigen::Stride<1, Eigen::Dynamic>(1, components));
    rows.setZero();
    for (int k = 0; k < kSlopes; ++k) {
      if (residuals[k] < 0) rows.row(k) = kSlopesOfComponents.row(k).head(components) / kFall;
    }
    for (int n = 0; n < components; ++n) rows(kSlopes + n, n) = 1 / prior_deviation(n + 1);
    return true;
  }
};

/// One channel, ready to be fitted with any number of components.
class ChannelFit {
 public:
  ChannelFit(const Knots& knots, const Observations& seen, std::size_t channel)
      : knots_(knots), scale_{knots.max_code(), seen.black_level[channel]} {
    const Eigen::MatrixXd& codes = seen.codes[channel];
    const Eigen::Index step = std::max<Eigen::Index>(1, (codes.rows() + kPoints - 1) / kPoints);
    for (Eigen::Index i = 0; i < codes.rows(); i += step) {
      Point point;
      for (Eigen::Index j = 0; j < codes.cols(); ++j) {
        if (!std::isnan(codes(i, j))) point.sights.push_back({knots.place(codes(i, j)), seen.ln_exposure[j], 1});
      }
      if (point.sights.size() >= 2) points_.push_back(std::move(point));
    }
    if (points_.empty()) return;
    weigh(Eigen::VectorXd());
    weigh(fit(kPilot, points_).coefficients);
  }

  bool empty() const { return points_.size() < kFolds; }

  struct Solution {
    Eigen::VectorXd coefficients;
    Eigen::MatrixXd covariance;
    double rms = 0;  ///< of the residuals in units of their expected deviation
    double rms_ln = 0;
    bool converged = false;
  };

  Solution fit(int components) const { return fit(components, points_); }

  /// Losses of the held-out residuals: count, sum, sum of squares.
  Eigen::Vector3d held_out(int components) const {
    std::vector<Point> kept, held;
    for (std::size_t i = 0; i < points_.size(); ++i) (i % kFolds == kFolds - 1 ? held : kept).push_back(points_[i]);
    const Solution solution = fit(components, kept);
    const Table table(knots_, scale_, solution.coefficients);
    Eigen::Vector3d score = Eigen::Vector3d::Zero();
    for (const Point& point : held) {
      const double loss = point_loss(point, table);
      score += Eigen::Vector3d(1, loss, loss * loss);
    }
    return score;
  }

  /// The mean of g(Z_ij) - ln H_j - ln E_i over the codes near each of `codes`: what this curve visibly gets wrong.
  Eigen::VectorXd misfit(const Solution& solution, const Eigen::VectorXd& codes) const {
    const Table table(knots_, scale_, solution.coefficients);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(kNeighbourhoods), weights = sums;
    for (const Point& point : points_) {
      std::vector<double> residuals(point.sights.size());
      PointTerm(point, table).Evaluate(nullptr, residuals.data(), nullptr);
      double squares = 0;
      for (const double r : residuals) squares += r * r;
      const double trust = 1 / (1 + squares / (kOutlier * kOutlier));
      for (std::size_t j = 0; j < residuals.size(); ++j) {
        const Point::Sight& s = point.sights[j];
        const int k = neighbourhood(knots_.code(s.place.knot));
        sums[k] += trust * s.weight * residuals[j];
        weights[k] += trust * s.weight * s.weight;
      }
    }
    Eigen::VectorXd misfit = Eigen::VectorXd::Zero(codes.size());
    for (Eigen::Index k = 0; k < codes.size(); ++k) {
      int seen = neighbourhood(codes[k]);
      // Where no code was seen the nearest towards the middle speaks.
      while (weights[seen] == 0 && seen != kNeighbourhoods / 2) seen += seen < kNeighbourhoods / 2 ? 1 : -1;
      if (weights[seen] > 0) misfit[k] = sums[seen] / weights[seen];
    }
    return misfit;
  }

  double ln_exposure(const EmorCurve& curve, double code) const { return curve.ln_exposure(scale_.value(code)); }

 private:
  int neighbourhood(double code) const {
    return std::clamp(static_cast<int>(code / (knots_.max_code() + 1) * kNeighbourhoods), 0, kNeighbourhoods - 1);
  }

  /// Cauchy's loss of a point's residuals, as the solver sees it.
  static double point_loss(const Point& point, const Table& table) {
    std::vector<double> residuals(point.sights.size());
    PointTerm(point, table).Evaluate(nullptr, residuals.data(), nullptr);
    double squares = 0;
    for (const double r : residuals) squares += r * r;
    return kOutlier * kOutlier * std::log1p(squares / (kOutlier * kOutlier));
  }

  /// The weight of a code is 1 / the deviation of its g: that of the code, through the slope of g; of the light; and of
  /// the basis, whose samples are a grain apart.
  void weigh(const Eigen::VectorXd& coefficients) {
    const Table table(knots_, scale_, coefficients);
    const double unit = (knots_.max_code() + 1) / 256;
    for (Point& point : points_) {
      for (Point::Sight& s : point.sights) {
        const int k = s.place.knot;
        const double slope = (table.g[k + 1] - table.g[k]) / (knots_.code(k + 1) - knots_.code(k));
        const double grain = 0.5 * kGrain / std::exp(table.g[k]);
        s.weight = 1 / std::hypot(kCodeNoise * unit * slope, kLeastNoise, grain);
      }
    }
  }

  Solution fit(int components, const std::vector<Point>& points) const {
    Solution solution;
    solution.coefficients = Eigen::VectorXd::Zero(components);
    Table table(knots_, scale_, solution.coefficients);
    ceres::CauchyLoss cauchy(kOutlier);
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.evaluation_callback = &table;
    ceres::Problem problem(options);
    for (const Point& point : points) {
      problem.AddResidualBlock(new PointTerm(point, table), &cauchy, solution.coefficients.data());
    }
    problem.AddResidualBlock(new PriorTerm(components), nullptr, solution.coefficients.data());
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    solver.max_num_iterations = 50;
    solver.function_tolerance = 1e-6;
    solver.num_threads = 1;  // sums in a fixed order
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    solution.converged = summary.termination_type == ceres::CONVERGENCE;
    finish(solution, points);
    return solution;
  }

  /// Residuals and covariance at the solution.
  void finish(Solution& solution, const std::vector<Point>& points) const {
    const auto components = solution.coefficients.size();
    const Table table(knots_, scale_, solution.coefficients);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(components, components);
    double squares = 0, freedom = 0, weights = 0;
    for (const Point& point : points) {
      const auto count = static_cast<Eigen::Index>(point.sights.size());
      Eigen::VectorXd residuals(count);
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows(count, components);
      double* jacobian = rows.data();
      PointTerm(point, table).Evaluate(nullptr, residuals.data(), &jacobian);
      const double trust = 1 / (1 + residuals.squaredNorm() / (kOutlier * kOutlier));
      information += trust * rows.transpose() * rows;
      squares += trust * residuals.squaredNorm();
      freedom += trust * static_cast<double>(count - 1);
      for (const Point::Sight& s : point.sights) weights += trust * s.weight * s.weight;
    }
    solution.rms = std::sqrt(squares / std::max(1.0, freedom));
    solution.rms_ln = std::sqrt(squares / weights);
    for (Eigen::Index n = 0; n < components; ++n) {
      const double deviation = prior_deviation(static_cast<int>(n) + 1);
      information(n, n) += 1 / (deviation * deviation);
    }
    solution.covariance = information.inverse() * std::max(1.0, solution.rms * solution.rms);
  }

  const Knots& knots_;
  Scale scale_;
  std::vector<Point> points_;
};

/// The fewest components that predict held-out points nearly as well as the best number does.
int choose_components(const std::vector<ChannelFit>& fits) {
  std::array<std::array<Eigen::Vector3d, kEmorComponents>, 3> parts;
  for_rows(3 * kEmorComponents, 1, [&](int first, int) {
    const auto c = static_cast<std::size_t>(first % 3);
    const int n = first / 3;
    parts[c][static_cast<std::size_t>(n)] = fits[c].empty() ? Eigen::Vector3d::Zero().eval() : fits[c].held_out(n + 1);
  });
  std::array<double, kEmorComponents> means{}, errors{};
  for (std::size_t n = 0; n < kEmorComponents; ++n) {
    const Eigen::Vector3d score = parts[0][n] + parts[1][n] + parts[2][n];
    if (score[0] == 0) return 1;
    means[n] = score[1] / score[0];
    errors[n] = std::sqrt(std::max(0.0, score[2] / score[0] - means[n] * means[n]) / score[0]);
  }
  const auto best = static_cast<std::size_t>(std::min_element(means.begin(), means.end()) - means.begin());
  const double limit = std::max(kTolerance * means[best], means[best] + errors[best]);
  std::size_t n = 0;
  while (means[n] > limit) ++n;
  return static_cast<int>(n) + 1;
}

EmorChannel finish(const ChannelFit& fit, const ChannelFit::Solution& solution, const Knots& knots,
                   const Eigen::VectorXd& codes) {
  EmorChannel channel;
  channel.coefficients = solution.coefficients;
  channel.rms = solution.rms_ln;
  channel.g.resize(codes.size());
  channel.stddev.resize(codes.size());
  const int components = static_cast<int>(solution.coefficients.size());
  const EmorCurve curve(solution.coefficients);
  const EmorCurve richer(fit.fit(std::min(kEmorComponents, components + 1)).coefficients);
  const double middle_code = knots.code(knots.middle());
  const double middle = fit.ln_exposure(curve, middle_code), richer_middle = fit.ln_exposure(richer, middle_code);
  const Eigen::VectorXd middle_gradient = curve.gradient(middle);
  const Eigen::VectorXd misfit = fit.misfit(solution, codes);
  for (Eigen::Index k = 0; k < codes.size(); ++k) {
    const double g = fit.ln_exposure(curve, codes[k]);
    const Eigen::VectorXd gradient = curve.gradient(g) - middle_gradient;
    const double noise = std::sqrt(gradient.dot(solution.covariance * gradient));
    const double model = (fit.ln_exposure(richer, codes[k]) - richer_middle) - (g - middle);
    const double family = kFamilyError / curve.slope(g);
    channel.g[k] = g - middle;
    channel.stddev[k] = std::hypot(std::hypot(noise, model, misfit[k]), std::hypot(family, 0.5 * kGrain / std::exp(g)));
  }
  return channel;
}

}  // namespace

EmorFit fit_emor(const Observations& observations, const Eigen::VectorXd& codes) {
  const Knots knots(observations.bits);
  std::vector<ChannelFit> fits;
  for (std::size_t c = 0; c < 3; ++c) fits.emplace_back(knots, observations, c);
  EmorFit result;
  result.components = choose_components(fits);
  std::array<ChannelFit::Solution, 3> solutions;
  for_rows(3, 1, [&](int first, int) {
    const auto c = static_cast<std::size_t>(first);
    if (fits[c].empty()) return;
    solutions[c] = fits[c].fit(result.components);
    result.channels[c] = finish(fits[c], solutions[c], knots, codes);
  });
  result.converged = true;
  for (std::size_t c = 0; c < 3; ++c)
    result.converged = result.converged && (fits[c].empty() || solutions[c].converged);
  return result;
}

}  // namespace hdr
