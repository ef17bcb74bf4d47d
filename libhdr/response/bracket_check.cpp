#include "libhdr/response/internal/bracket_check.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

constexpr int kFewestEquations = 24;  ///< below this even a smooth curve is a guess
constexpr const char* kChannelNames[3] = {"red", "green", "blue"};

/// Equations left for g when each point's ln E is eliminated.
std::int64_t equations(const Eigen::MatrixXd& codes) {
  return codes.array().isFinite().count() - codes.rows();
}

}  // namespace

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
    throw Error(first +
                ": all exposures are equal and do not determine a response; vary them or merge with --response srgb");
  }
}

std::vector<std::string> check_coverage(Observations& seen, const Bracket& bracket) {
  const double max_code = std::ldexp(1.0, seen.bits) - 1;
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
    if (lowest > 0.06 * max_code || highest < 0.94 * max_code) {
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

void check_brightening(const Observations& seen, const Bracket& bracket) {
  std::int64_t brighter = 0, pairs = 0;
  for (const Eigen::MatrixXd& codes : seen.codes) {
    for (Eigen::Index j = 0; j + 1 < codes.cols(); ++j) {
      const double longer = seen.ln_exposure[j + 1] - seen.ln_exposure[j];
      if (longer == 0) continue;
      for (Eigen::Index i = 0; i < codes.rows(); ++i) {
        if (std::isnan(codes(i, j)) || std::isnan(codes(i, j + 1))) continue;
        ++pairs;
        brighter += (codes(i, j + 1) - codes(i, j)) * longer > 0;
      }
    }
  }
  if (2 * brighter > pairs || pairs == 0) return;
  throw Error(bracket.shots.front().path.string() +
              ": longer exposures are not brighter in this bracket; check the times against the files");
}

void borrow_curves(std::array<std::vector<double>, 3>& curves_of_channels) {
  std::vector<double> mean;
  double curves = 0;
  for (const std::vector<double>& curve : curves_of_channels) {
    if (curve.empty()) continue;
    if (mean.empty()) mean.resize(curve.size());
    for (std::size_t k = 0; k < curve.size(); ++k) mean[k] += curve[k];
    ++curves;
  }
  for (double& value : mean) value /= curves;
  for (std::vector<double>& curve : curves_of_channels) {
    if (curve.empty()) curve = mean;
  }
}

}  // namespace hdr
