// [Robertson03] Estimation-theoretic approach to dynamic range enhancement using multiple exposures, section 3.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/response/calibrate.h"
#include "libhdr/response/internal/bracket_check.h"
#include "libhdr/response/internal/fill_gaps.h"
#include "libhdr/response/internal/monotone.h"
#include "libhdr/response/internal/sample_places.h"

namespace hdr {
namespace {

constexpr int kPixels = 20000;  ///< the paper takes all; this many say as much, whatever the picture's size
constexpr int kMostIterations = 500;
/// Decrease of the objective in one iteration, as a share of it. Nothing else keeps the curve smooth: past this it fits
/// noise, and the waves that exposures in uniform steps leave free.
constexpr double kConverged = 1e-3;

/// [Robertson03] The weight of a code: a Gaussian about the middle, shifted and scaled to be 0 at both ends and 1
/// there.
double weight(double code, double max_code) {
  const double z = 2 * code / max_code - 1;
  return (std::exp(-4 * z * z) - std::exp(-4)) / (1 - std::exp(-4));
}

/// The pixels of one channel: pixel i was seen as samples [first[i], first[i + 1]).
struct Pixels {
  struct Sample {
    int level;  ///< index of the code in Response::g
    double exposure, weight;
  };
  std::vector<Sample> samples;
  std::vector<std::size_t> first;
};

/// Whole codes of single pixels, one in each cell of a grid; NaN where they are too dark or bright to follow the light.
Observations sample_pixels(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo, int pixels) {
  Observations seen;
  seen.bits = bracket.bits();
  internal::CodesAtPlaces sample(bracket, ref_from_photo, internal::jittered_places(bracket.size(), pixels));
  sample.look_at(bracket);
  const std::vector<internal::SamplePlace>& places = sample.places();
  const std::array<std::vector<int>, 3>& codes = sample.codes();
  const std::size_t shots = bracket.shots.size();
  seen.ln_exposure.resize(static_cast<Eigen::Index>(shots));
  for (std::size_t c = 0; c < 3; ++c) {
    Eigen::MatrixXd& matrix = seen.codes[c];
    matrix.resize(static_cast<Eigen::Index>(places.size()), static_cast<Eigen::Index>(shots));
    for (std::size_t j = 0; j < shots; ++j) {
      const Photo& photo = bracket.shots[j];
      const auto column = static_cast<Eigen::Index>(j);
      seen.ln_exposure[column] = std::log(photo.relative_exposure());
      const UsableCodes usable = usable_codes(seen.bits, photo.lossy);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const int code = codes[c][i * shots + j];
        matrix(static_cast<Eigen::Index>(i), column) = code >= 0 && usable.contains(code) ? code : NAN;
      }
    }
    matrix = rows_seen_twice(matrix, seen.ln_exposure);
  }
  return seen;
}

Pixels pixels_of_channel(const Observations& seen, std::size_t channel) {
  const Eigen::MatrixXd& codes = seen.codes[channel];
  const double levels_per_code = seen.bits <= 8 ? 1 : std::ldexp(1.0, 12 - seen.bits);
  const double max_code = std::ldexp(1.0, seen.bits) - 1;
  const Eigen::VectorXd exposure = (seen.ln_exposure.array() - seen.ln_exposure.mean()).exp();
  Pixels pixels;
  pixels.first.push_back(0);
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    for (Eigen::Index j = 0; j < codes.cols(); ++j) {
      if (std::isnan(codes(i, j))) continue;
      // 16-bit codes share 4096 samples: the nearest is within half a sample.
      const int level =
          std::min(static_cast<int>(std::lround(codes(i, j) * levels_per_code)), response_levels(seen.bits) - 1);
      pixels.samples.push_back({level, exposure[j], weight(codes(i, j), max_code)});
    }
    pixels.first.push_back(pixels.samples.size());
  }
  return pixels;
}

struct CurveEstimate {
  std::vector<double> g, deviation;
  double squares = 0, weights = 0;  ///< of w_ij [g(y_ij) - ln x_i - ln t_j]^2
  bool converged = false;
};

/// One channel's alternation.
class Alternation {
 public:
  Alternation(const Pixels& pixels, int levels)
      : pixels_(pixels),
        irradiance_(pixels.first.size() - 1),
        exposure_(static_cast<std::size_t>(levels)),
        count_(exposure_.size()) {
    for (const Pixels::Sample& s : pixels.samples) ++count_[static_cast<std::size_t>(s.level)];
    for (std::size_t m = 0; m < exposure_.size(); ++m) {
      if (count_[m] > 0) exposure_[m] = static_cast<double>(m);  // a linear camera
    }
    normalise();
  }

  /// Until the objective stops falling.
  bool run() {
    double last = INFINITY;
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      estimate_irradiances();
      const double objective = this->objective();
      if (last - objective <= kConverged * objective) return true;
      last = objective;
      estimate_exposures();
      normalise();
    }
    return false;
  }

  std::vector<double> exposures() const { return fill_gaps(exposure_); }

  /// Standard deviation of ln I_m: of the mean over the samples that had code m, ln; NaN where there are fewer than
  /// two.
  std::vector<double> deviations() const {
    std::vector<double> squares(exposure_.size());
    for_each_sample([&](std::size_t i, const Pixels::Sample& s) {
      const auto m = static_cast<std::size_t>(s.level);
      const double error = s.exposure * irradiance_[i] / exposure_[m] - 1;
      squares[m] += error * error;
    });
    for (std::size_t m = 0; m < squares.size(); ++m) {
      squares[m] = count_[m] >= 2 ? std::sqrt(squares[m] / (count_[m] * (count_[m] - 1))) : NAN;
    }
    return squares;
  }

  template <class Body>
  void for_each_sample(const Body& body) const {
    for (std::size_t i = 0; i + 1 < pixels_.first.size(); ++i) {
      for (std::size_t s = pixels_.first[i]; s < pixels_.first[i + 1]; ++s) body(i, pixels_.samples[s]);
    }
  }
  double irradiance(std::size_t pixel) const { return irradiance_[pixel]; }

 private:
  /// x_i = sum_j w_ij t_j I_{y_ij} / sum_j w_ij t_j^2, the minimum over x of the objective.
  void estimate_irradiances() {
    for (std::size_t i = 0; i < irradiance_.size(); ++i) {
      double above = 0, below = 0;
      for (std::size_t s = pixels_.first[i]; s < pixels_.first[i + 1]; ++s) {
        const Pixels::Sample& sample = pixels_.samples[s];
        above += sample.weight * sample.exposure * exposure_[static_cast<std::size_t>(sample.level)];
        below += sample.weight * sample.exposure * sample.exposure;
      }
      irradiance_[i] = above / below;
    }
  }

  /// I_m = the mean of t_j x_i over all samples with code m, the minimum over I of the objective.
  void estimate_exposures() {
    std::fill(exposure_.begin(), exposure_.end(), 0);
    for_each_sample([&](std::size_t i, const Pixels::Sample& s) {
      exposure_[static_cast<std::size_t>(s.level)] += s.exposure * irradiance_[i];
    });
    for (std::size_t m = 0; m < exposure_.size(); ++m) {
      if (count_[m] > 0) exposure_[m] /= count_[m];
    }
  }

  /// I_middle = 1. The scale is free, and without it the objective would shrink to nothing.
  void normalise() {
    const double middle = fill_gaps(exposure_)[exposure_.size() / 2];
    for (double& value : exposure_) value /= middle;
  }

  /// sum_ij w_ij (I_{y_ij} - t_j x_i)^2
  double objective() const {
    double sum = 0;
    for_each_sample([&](std::size_t i, const Pixels::Sample& s) {
      const double error = exposure_[static_cast<std::size_t>(s.level)] - s.exposure * irradiance_[i];
      sum += s.weight * error * error;
    });
    return sum;
  }

  const Pixels& pixels_;
  std::vector<double> irradiance_;
  std::vector<double> exposure_;  ///< I_m, 0 for codes that no pixel has
  std::vector<double> count_;
};

/// Codes that no pixel had are as doubtful as their nearest neighbour, and more by how far away it is in g. Infinite
/// where no code's deviation is known.
void fill_deviations(std::vector<double>& deviation, const std::vector<double>& g) {
  const std::vector<double> known = deviation;
  std::vector<double> nearest(known.size(), INFINITY);
  double value = NAN, at = 0;
  const auto pass = [&](std::size_t k) {
    if (!std::isnan(known[k])) {
      value = known[k];
      at = g[k];
    }
    if (!std::isnan(value)) nearest[k] = std::min(nearest[k], std::hypot(value, 0.5 * (g[k] - at)));
  };
  for (std::size_t k = 0; k < known.size(); ++k) pass(k);
  value = NAN;
  for (std::size_t k = known.size(); k-- > 0;) pass(k);
  deviation = nearest;
}

CurveEstimate estimate(const Pixels& pixels, int bits) {
  CurveEstimate result;
  Alternation alternation(pixels, response_levels(bits));
  result.converged = alternation.run();
  std::vector<double> exposures = alternation.exposures();
  make_nondecreasing(exposures);
  // Code 0 stands for half the exposure of code 1/2 (Response).
  Response codes;
  codes.bits = bits;
  exposures[0] = 0.5 * exposures[1] * 0.5 / codes.code_from_level(1);
  const double middle = exposures[exposures.size() / 2];
  for (const double exposure : exposures) result.g.push_back(std::log(exposure / middle));
  result.deviation = alternation.deviations();
  fill_deviations(result.deviation, result.g);
  const double scale = std::log(middle);
  alternation.for_each_sample([&](std::size_t i, const Pixels::Sample& s) {
    const double error = result.g[static_cast<std::size_t>(s.level)] + scale - std::log(alternation.irradiance(i)) -
                         std::log(s.exposure);
    result.squares += s.weight * error * error;
    result.weights += s.weight;
  });
  return result;
}

}  // namespace

Calibration calibrate_robertson(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                                const CalibrateOptions& options) {
  check_exposures(bracket);
  Observations seen = sample_pixels(bracket, ref_from_photo, options.pixels > 0 ? options.pixels : kPixels);
  Calibration result;
  result.warnings = check_coverage(seen, bracket);
  check_brightening(seen, bracket);
  for (const Photo& photo : bracket.shots) result.seconds.push_back(photo.exposure.seconds.value_or(0));
  std::array<CurveEstimate, 3> estimates;
  for_rows(3, 1, [&](int first, int) {
    const auto c = static_cast<std::size_t>(first);
    if (seen.codes[c].rows() > 0) estimates[c] = estimate(pixels_of_channel(seen, c), seen.bits);
  });
  result.response.bits = seen.bits;
  result.converged = true;
  double squares = 0, weights = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (seen.codes[c].rows() == 0) continue;
    result.response.g[c] = estimates[c].g;
    result.deviation[c] = estimates[c].deviation;
    if (!std::isfinite(result.deviation[c].front())) {
      throw Error(bracket.shots.front().path.string() +
                  ": no code was met twice in this bracket, so that any curve would explain it; take more pixels, or "
                  "Debevec and Malik's method, which joins codes that are neighbours");
    }
    result.converged = result.converged && estimates[c].converged;
    result.pixels += static_cast<int>(seen.codes[c].rows());
    squares += estimates[c].squares;
    weights += estimates[c].weights;
  }
  result.rms_log_error = std::sqrt(squares / weights);
  borrow_curves(result.response.g);
  borrow_curves(result.deviation);
  return result;
}

}  // namespace hdr
