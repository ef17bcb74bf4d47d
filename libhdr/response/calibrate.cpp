// From a bracket to a Calibration: the checks, the points, the smoothness, the fit of each channel, honest ends.
#include "libhdr/response/calibrate.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/response/internal/debevec_malik.h"
#include "libhdr/response/internal/knots.h"
#include "libhdr/response/internal/observations.h"
#include "libhdr/response/internal/smoothness.h"

namespace hdr {
namespace {

constexpr int kPoints = 1200;          ///< a channel
constexpr int kFewestEquations = 24;   ///< below this even a smooth curve is a guess
constexpr double kStiff = 0.1;         ///< smoothness before the data have spoken
constexpr double kWideOutliers = 0.1;  ///< scale of the loss before the residuals are known, ln
constexpr const char* kChannelNames[3] = {"red", "green", "blue"};

void check_exposures(const Bracket& bracket) {
  if (bracket.shots.empty()) throw Error("no shots: nothing to calibrate; name two or more photographs");
  const std::string first = bracket.shots.front().path.string();
  if (bracket.shots.size() == 1) {
    throw Error(first + ": one shot alone does not determine a response; add exposures or merge with --response srgb");
  }
  double least = INFINITY, most = 0;
  for (const Photo& photo : bracket.shots) {
    const double exposure = photo.relative_exposure();
    if (!(exposure > 0 && std::isfinite(exposure))) {
      throw Error(photo.path.string() + ": its exposure is not a positive number; pass --times");
    }
    least = std::min(least, exposure);
    most = std::max(most, exposure);
  }
  if (!(most > 1.001 * least)) {
    throw Error(first + ": all exposures are equal and do not determine a response; vary them or merge with --response srgb");
  }
}

/// Equations left for g when each point's ln E is eliminated.
std::int64_t equations(const Eigen::MatrixXd& codes) {
  return codes.array().isFinite().count() - codes.rows();
}

/// What lies this many standard deviations from a robust fit moved, or is not what its neighbours are.
constexpr double kOutlier = 5;

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

/// The nearest nondecreasing sequence (pool adjacent violators).
void make_nondecreasing(std::vector<double>& values) {
  struct Block {
    double mean;
    std::size_t count;
  };
  std::vector<Block> blocks;
  for (const double value : values) {
    blocks.push_back({value, 1});
    while (blocks.size() > 1 && blocks[blocks.size() - 2].mean > blocks.back().mean) {
      const Block last = blocks.back();
      blocks.pop_back();
      Block& pooled = blocks.back();
      const std::size_t count = pooled.count + last.count;
      pooled.mean = (pooled.mean * static_cast<double>(pooled.count) + last.mean * static_cast<double>(last.count)) /
                    static_cast<double>(count);
      pooled.count = count;
    }
  }
  auto out = values.begin();
  for (const Block& block : blocks) out = std::fill_n(out, block.count, block.mean);
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

std::array<CurveFit, 3> fit_channels(const Knots& knots, const Observations& seen, double smoothness,
                                     std::optional<double> outlier_scale = {}) {
  std::array<CurveFit, 3> fits;
  for_rows(3, 1, [&](int first, int) {
    const auto c = static_cast<std::size_t>(first);
    if (seen.codes[c].rows() > 0)
      fits[c] = fit_curve(knots, seen.codes[c], seen.ln_exposure, smoothness, outlier_scale);
  });
  return fits;
}

/// The spread of the residuals of a robust fit tells outliers from noise; without them plain least squares will do.
void drop_outliers(Observations& seen, const Knots& knots, const std::array<CurveFit, 3>& fits) {
  std::array<Eigen::MatrixXd, 3> residuals;
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() > 0) residuals[c] = weighted_residuals(knots, fits[c].g, seen.codes[c], seen.ln_exposure);
  }
  const double limit = std::max(1e-6, kOutlier * residual_scale(residuals));
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() == 0) continue;
    seen.codes[c] = (residuals[c].array().abs() > limit).select(NAN, seen.codes[c].array()).matrix().eval();
    seen.codes[c] = rows_seen_twice(seen.codes[c], seen.ln_exposure);
  }
}

/// Throws away what cannot determine a curve; says which codes are extrapolated.
std::vector<std::string> check_coverage(Observations& seen, const Knots& knots, const Bracket& bracket) {
  std::vector<std::string> warnings;
  int determined = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (equations(seen.codes[c]) < kFewestEquations) {
      seen.codes[c].resize(0, seen.ln_exposure.size());
      warnings.push_back(std::string(kChannelNames[c]) +
                         ": black or clipped nearly everywhere; its response is the mean of the other channels'");
      continue;
    }
    ++determined;
    const auto finite = seen.codes[c].array().isFinite();
    const double lowest = finite.select(seen.codes[c].array(), INFINITY).minCoeff();
    const double highest = finite.select(seen.codes[c].array(), -INFINITY).maxCoeff();
    if (lowest > 0.06 * knots.max_code() || highest < 0.94 * knots.max_code()) {
      warnings.push_back(std::string(kChannelNames[c]) + ": no two shots share codes below " +
                         std::to_string(std::lround(lowest)) + " or above " + std::to_string(std::lround(highest)) +
                         "; the response is extrapolated there");
    }
  }
  if (determined == 0) {
    throw Error(bracket.shots.front().path.string() +
                ": too few pixels are neither black nor clipped in two shots to determine a response; "
                "take exposures closer together or merge with --response srgb");
  }
  return warnings;
}

/// A channel without a curve of its own borrows the mean of the others.
void borrow_curves(Response& response) {
  std::vector<double> mean;
  double curves = 0;
  for (const std::vector<double>& curve : response.g) {
    if (curve.empty()) continue;
    if (mean.empty()) mean.resize(curve.size());
    for (std::size_t k = 0; k < curve.size(); ++k) mean[k] += curve[k];
    ++curves;
  }
  for (double& value : mean) value /= curves;
  for (std::vector<double>& curve : response.g) {
    if (curve.empty()) curve = mean;
  }
}

Calibration calibrate(Observations seen, const Bracket& bracket, std::optional<double> smoothness) {
  const Knots first_knots(seen.bits);
  Calibration result;
  result.warnings = check_coverage(seen, first_knots, bracket);
  drop_outliers(seen, first_knots, fit_channels(first_knots, seen, smoothness.value_or(kStiff), kWideOutliers));
  const SmoothnessChoice choice =
      smoothness ? SmoothnessChoice{*smoothness, INFINITY} : choose_smoothness(seen.bits, seen.codes, seen.ln_exposure);
  result.smoothness = choice.smoothness;
  const Knots knots(seen.bits, choice.shoulder);
  const std::array<CurveFit, 3> fits = fit_channels(knots, seen, choice.smoothness);
  result.converged = true;
  result.response.bits = seen.bits;
  double squares = 0, count = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() == 0) continue;
    result.response.g[c] = curve_from_fit(knots, fits[c].g, seen.bits, seen.black_level[c]);
    if (!(result.response.g[c].back() > result.response.g[c].front() + 0.1)) {
      throw Error(bracket.shots.front().path.string() +
                  ": longer exposures are not brighter in this bracket; check the times against the files");
    }
    const auto terms = static_cast<double>(seen.codes[c].array().isFinite().count());
    squares += fits[c].rms * fits[c].rms * terms;
    count += terms;
    result.converged = result.converged && fits[c].converged;
    result.pixels += static_cast<int>(seen.codes[c].rows());
  }
  result.rms_log_error = std::sqrt(squares / count);
  borrow_curves(result.response);
  return result;
}

}  // namespace

Calibration calibrate_debevec_malik(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                                    const CalibrateOptions& options) {
  check_exposures(bracket);
  return calibrate(sample_points(bracket, ref_from_photo, options.pixels > 0 ? options.pixels : kPoints), bracket,
                   options.smoothness);
}

Response provisional_response(const Bracket& bracket) {
  check_exposures(bracket);
  return calibrate(match_quantiles(bracket), bracket, kStiff).response;
}

}  // namespace hdr
