// From a bracket to a Calibration: the checks, the points, the smoothness, the fit of each channel, honest ends.
#include "libhdr/response/calibrate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/response/internal/bracket_check.h"
#include "libhdr/response/internal/code_weights.h"
#include "libhdr/response/internal/curve_prior.h"
#include "libhdr/response/internal/debevec_malik.h"
#include "libhdr/response/internal/knots.h"
#include "libhdr/response/internal/monotone.h"
#include "libhdr/response/internal/noise_bias.h"
#include "libhdr/response/internal/noise_of_codes.h"
#include "libhdr/response/internal/normal_equations.h"
#include "libhdr/response/internal/observations.h"
#include "libhdr/response/internal/refine_times.h"
#include "libhdr/response/internal/smoothness.h"
#include "libhdr/response/internal/top_codes.h"

namespace hdr {
namespace {

constexpr int kPoints = 1200;          ///< a channel
constexpr double kStiff = 0.1;         ///< smoothness before the data have spoken
constexpr double kFirstCurve = 1;      ///< smoothness of the curve by which noise is measured
constexpr double kWideOutliers = 0.1;  ///< scale of the loss before the residuals are known, ln

/// What lies this many standard deviations from a robust fit moved, or is not what its neighbours are.
constexpr double kOutlier = 5;

using Weights = std::array<CodeWeights, 3>;

/// Robust standard deviation of all residuals: 1.4826 x the median of their sizes.
double residual_scale(const std::array<Eigen::MatrixXd, 3>& residuals) {
  std::vector<double> sizes;
  for (const Eigen::MatrixXd& channel : residuals) {
    for (const double r : channel.reshaped()) {
      if (!std::isnan(r)) sizes.push_back(std::abs(r));
    }
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return 1.4826 * *middle;
}

std::vector<double> curve_from_fit(const Knots& knots, const Eigen::VectorXd& g, int bits, double black_level) {
  const auto at = [&](double code) {
    const Knots::Place place = knots.place(code);
    return (1 - place.t) * g[place.knot] + place.t * g[place.knot + 1];
  };
  Response codes;
  codes.bits = bits;
  std::vector<double> curve;
  // g(0) is half the exposure of code 1/2, as Response has it, and so are all codes up to a black level.
  const double black = at(black_level + 0.5) - std::log(2.0);
  for (int level = 0; level < response_levels(bits); ++level) {
    const double code = codes.code_from_level(level);
    curve.push_back(code <= black_level ? black : at(code));
  }
  make_nondecreasing(curve);
  const double middle = curve[curve.size() / 2];
  for (double& value : curve) value -= middle;
  return curve;
}

/// From the knots to the samples of a response.
std::vector<double> deviation_at_samples(const Knots& knots, const Eigen::VectorXd& deviation,
                                         const Response& response) {
  std::vector<double> at_samples;
  for (int level = 0; level < response_levels(response.bits); ++level) {
    const Knots::Place place = knots.place(response.code_from_level(level));
    at_samples.push_back((1 - place.t) * deviation[place.knot] + place.t * deviation[place.knot + 1]);
  }
  return at_samples;
}

std::array<CurveFit, 3> fit_channels(const Knots& knots, const Weights& weights, const Observations& seen,
                                     double smoothness, std::optional<double> outlier_scale = {},
                                     const std::array<Eigen::VectorXd, 3>& priors = {}) {
  std::array<CurveFit, 3> fits;
  for_rows(3, 1, [&](int first, int) {
    const auto c = static_cast<std::size_t>(first);
    if (seen.codes[c].rows() > 0)
      fits[c] = fit_curve(knots, weights[c], seen.codes[c], seen.ln_exposure, smoothness, outlier_scale, priors[c]);
  });
  return fits;
}

/// The spread of the residuals of a robust fit tells outliers from noise; without them plain least squares will do.
void drop_outliers(Observations& seen, const Knots& knots, const Weights& weights,
                   const std::array<CurveFit, 3>& fits) {
  std::array<Eigen::MatrixXd, 3> residuals;
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() > 0)
      residuals[c] = weighted_residuals(knots, weights[c], fits[c].g, seen.codes[c], seen.ln_exposure);
  }
  const double limit = std::max(1e-6, kOutlier * residual_scale(residuals));
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() == 0) continue;
    seen.codes[c] = (residuals[c].array().abs() > limit).select(NAN, seen.codes[c].array()).matrix().eval();
    seen.codes[c] = rows_seen_twice(seen.codes[c], seen.ln_exposure);
  }
}

/// ln H_j as refined. Times that are labels of a camera's dial are tried as the powers of two that they stand for, too.
/// Twice: the noise that tells outliers from errors of the times is known only when the times are.
void refine_exposures(Observations& seen, const Bracket& bracket, const Knots& knots, double smoothness,
                      Calibration& result) {
  const auto shots = static_cast<Eigen::Index>(bracket.shots.size());
  Eigen::VectorXd seconds(shots);
  for (Eigen::Index j = 0; j < shots; ++j) seconds[j] = *bracket.shots[static_cast<std::size_t>(j)].exposure.seconds;
  const Eigen::VectorXd given = seen.ln_exposure;
  const Eigen::VectorXd snapped = given + snapped_ln_times(seconds) - seconds.array().log().matrix();
  double best = INFINITY;
  for (const Eigen::VectorXd& start : {given, snapped}) {
    Observations trial = seen;
    trial.ln_exposure = start;
    double noise = 0.02;  // a few codes
    RefinedTimes refined;
    for (int pass = 0; pass < 2; ++pass) {
      refined = refine_times(knots, trial, smoothness, noise);
      noise = std::max(1e-4, refined.rms);
    }
    // Both starts end at times that explain the pictures; the likelier one needed the smaller corrections.
    const double surprise = refined.count * std::log(refined.rms * refined.rms) + refined.prior;
    if (!(surprise < best)) continue;
    best = surprise;
    seen.ln_exposure = start + refined.correction;
    if (snapped == given) break;
  }
  for (std::size_t j = 0; j < result.seconds.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    result.seconds[j] *= std::exp(seen.ln_exposure[k] - given[k]);
  }
}

void warn_of_uniform_steps(double step, std::vector<std::string>& warnings) {
  char text[200];
  std::snprintf(text, sizeof text,
                "all exposures are steps of %.1f EV apart, which leaves the response open to waves of that period; one "
                "more shot off the grid (at +%.1f EV, say) would settle it",
                step, step / 3);
  warnings.emplace_back(text);
}

/// The noise of the points, and what the choice of a smoothness is worth: how far the curve moves when it is ten times
/// less smooth, or when smoothness is judged with the other shoulder. The stiffest curve that the data admit is a
/// little stiff.
Eigen::VectorXd total_deviation(const Knots& knots, const CodeWeights& weights, const Observations& seen, std::size_t c,
                                const SmoothnessChoice& choice, const CurveFit& fit, const Eigen::VectorXd& prior) {
  const NormalEquations equations_for_g(knots, weights, seen.codes[c], seen.ln_exposure);
  const Eigen::VectorXd random = equations_for_g.deviation(choice.smoothness, fit.rms);
  Eigen::VectorXd systematic = (equations_for_g.solve(0.1 * choice.smoothness, prior) - fit.g).cwiseAbs();
  if (prior.size() > 0) {
    systematic = systematic.cwiseMax((equations_for_g.solve(0.01 * choice.smoothness) - fit.g).cwiseAbs());
  }
  // Where two curves cross, their distance says nothing: the largest among neighbours does.
  Eigen::VectorXd total(knots.count());
  const int reach = knots.count() / 32;
  for (int k = 0; k < knots.count(); ++k) {
    const int first = std::max(0, k - reach), last = std::min(knots.count() - 1, k + reach);
    total[k] = std::hypot(random[k], systematic.segment(first, last - first + 1).maxCoeff());
  }
  total[knots.middle()] = 0;
  return total;
}

/// What is to be fitted, and how smooth.
struct CurveProblem {
  Observations seen;
  Weights weights;
  Knots knots;
  SmoothnessChoice choice;
  std::array<Eigen::VectorXd, 3> priors;
};

/// The hat's weights and a smoothness that is not chosen yet.
CurveProblem pose(Observations seen, const Bracket& bracket, std::optional<double> smoothness, bool refine,
                  Calibration& result) {
  const Knots first_knots(seen.bits);
  for (const Photo& photo : bracket.shots) result.seconds.push_back(photo.exposure.seconds.value_or(0));
  result.warnings = check_coverage(seen, bracket);
  check_brightening(seen, bracket);
  if (refine) refine_exposures(seen, bracket, first_knots, smoothness.value_or(kStiff), result);
  const double ambiguous = ambiguous_step(seen.ln_exposure);
  if (ambiguous > 0) warn_of_uniform_steps(ambiguous, result.warnings);
  const CodeWeights hat = CodeWeights::hat(seen.bits);
  const Weights weights{hat, hat, hat};
  drop_outliers(seen, first_knots, weights,
                fit_channels(first_knots, weights, seen, smoothness.value_or(kStiff), kWideOutliers));
  return {std::move(seen), weights, first_knots, {smoothness.value_or(kFirstCurve), INFINITY}, {}};
}

/// From the data: how smooth, and with what prior.
void choose(CurveProblem& problem) {
  const Observations& seen = problem.seen;
  problem.priors = emor_prior(Knots(seen.bits), seen);
  problem.choice = choose_smoothness(seen.bits, problem.weights, seen.codes, seen.ln_exposure, problem.priors);
  if (!problem.choice.prior) problem.priors = {};
  problem.knots = Knots(seen.bits, problem.choice.shoulder);
}

/// The response that curves at the knots stand for; channels without a curve borrow another's.
Response response_from_curves(const CurveProblem& problem, const std::array<Eigen::VectorXd, 3>& curves,
                              const Bracket& bracket) {
  const Observations& seen = problem.seen;
  Response response;
  response.bits = seen.bits;
  for (std::size_t c = 0; c < 3; ++c) {
    if (curves[c].size() == 0) continue;
    response.g[c] = curve_from_fit(problem.knots, curves[c], seen.bits, seen.black_level[c]);
    if (!(response.g[c].back() > response.g[c].front() + 0.1)) {
      throw Error(bracket.shots.front().path.string() +
                  ": longer exposures are not brighter in this bracket; check the times against the files");
    }
  }
  borrow_curves(response.g);
  return response;
}

/// A response by which more is learnt of the bracket: the same least squares, without the doubt, by their normal
/// equations.
Response interim_response(const CurveProblem& problem, const Bracket& bracket) {
  const Observations& seen = problem.seen;
  std::array<Eigen::VectorXd, 3> curves;
  for_rows(3, 1, [&](int first, int) {
    const auto c = static_cast<std::size_t>(first);
    if (seen.codes[c].rows() == 0) return;
    curves[c] = NormalEquations(problem.knots, problem.weights[c], seen.codes[c], seen.ln_exposure)
                    .solve(problem.choice.smoothness, problem.priors[c]);
  });
  return response_from_curves(problem, curves, bracket);
}

/// The response and all that is known of it.
void solve(const CurveProblem& problem, const Bracket& bracket, Calibration& result) {
  const Observations& seen = problem.seen;
  const std::array<CurveFit, 3> fits =
      fit_channels(problem.knots, problem.weights, seen, problem.choice.smoothness, {}, problem.priors);
  result.response = response_from_curves(problem, {fits[0].g, fits[1].g, fits[2].g}, bracket);
  result.smoothness = problem.choice.smoothness;
  result.converged = true;
  double squares = 0, count = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() == 0) continue;
    const Eigen::VectorXd doubt =
        total_deviation(problem.knots, problem.weights[c], seen, c, problem.choice, fits[c], problem.priors[c]);
    result.deviation[c] = deviation_at_samples(problem.knots, doubt, result.response);
    const auto terms = static_cast<double>(seen.codes[c].array().isFinite().count());
    squares += fits[c].rms * fits[c].rms * terms;
    count += terms;
    result.converged = result.converged && fits[c].converged;
    result.pixels += static_cast<int>(seen.codes[c].rows());
  }
  result.rms_log_error = std::sqrt(squares / count);
  borrow_curves(result.deviation);
}

/// Weighs the codes by the noise that the shots show, which needs a curve to be told, and fits. Lossless shots also
/// lose the bias of their noise, twice, since the first curve is off where noise is large; compression averages noise
/// away before it can be told from its own.
void solve_with_noise(CurveProblem& problem, const Bracket& bracket, const internal::CodesAtPlaces& noise_places,
                      bool choose_smoothness, Calibration& result) {
  const bool lossy = std::any_of(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.lossy; });
  const Eigen::VectorXd exposures = problem.seen.ln_exposure.array().exp();
  Response response = interim_response(problem, bracket);
  const NoiseEstimate estimate =
      internal::estimate_noise(bracket, noise_places, response, {}, {exposures.begin(), exposures.end()});
  const Observations observed = problem.seen;
  const int passes = lossy ? 1 : 2;
  for (int pass = 0; pass < passes; ++pass) {
    if (pass > 0) response = interim_response(problem, bracket);
    if (!lossy) problem.seen = without_noise_bias(observed, response, estimate.noise);
    for (std::size_t c = 0; c < 3; ++c) {
      problem.weights[c] =
          CodeWeights::from_noise(response, static_cast<int>(c), estimate.noise[c], problem.seen.codes[c]);
    }
    if (choose_smoothness) choose(problem);
  }
  solve(problem, bracket, result);
  if (!lossy) result.noise = estimate;
}

}  // namespace

Calibration calibrate_debevec_malik(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                                    const CalibrateOptions& options) {
  check_exposures(bracket);
  Calibration result;
  // All that is looked at is read in one go: shots that are not in memory are decoded once.
  internal::CodesAtPlaces for_noise = internal::noise_places(bracket, ref_from_photo);
  internal::CodesAtPlaces for_top = top_places(bracket, ref_from_photo);
  internal::CodesAtPlaces* const onlookers[] = {&for_noise, &for_top};
  const int points = options.pixels > 0 ? options.pixels : kPoints;
  CurveProblem problem = pose(sample_points(bracket, ref_from_photo, points, onlookers), bracket, options.smoothness,
                              options.refine_times, result);
  solve_with_noise(problem, bracket, for_noise, !options.smoothness, result);
  measure_top_codes(bracket, problem.seen.ln_exposure, for_top, result.deviation, result.response);
  return result;
}

std::optional<CalibrateMethod> calibrate_method_from_name(const std::string& name) {
  if (name == "debevec-malik") return CalibrateMethod::kDebevecMalik;
  if (name == "robertson") return CalibrateMethod::kRobertson;
  if (name == "mitsunaga-nayar") return CalibrateMethod::kMitsunagaNayar;
  return std::nullopt;
}

Calibration calibrate(CalibrateMethod method, const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                      const CalibrateOptions& options) {
  switch (method) {
    case CalibrateMethod::kRobertson:
      return calibrate_robertson(bracket, ref_from_photo, options);
    case CalibrateMethod::kMitsunagaNayar:
      return calibrate_mitsunaga_nayar(bracket, ref_from_photo, options);
    case CalibrateMethod::kDebevecMalik:
      break;
  }
  return calibrate_debevec_malik(bracket, ref_from_photo, options);
}

Response provisional_response(const Bracket& bracket) {
  check_exposures(bracket);
  Observations seen = match_quantiles(bracket);
  check_coverage(seen, bracket);  // channels that tell nothing are dropped; the calibration warns of them
  check_brightening(seen, bracket);
  // Quantiles are of all pixels: none of them is an outlier, and no robust fit has to find any.
  const CodeWeights hat = CodeWeights::hat(seen.bits);
  const Knots knots(seen.bits);
  return interim_response({std::move(seen), {hat, hat, hat}, knots, {kStiff, INFINITY}, {}}, bracket);
}

}  // namespace hdr
