#include "libhdr/response/internal/top_codes.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "libhdr/response/internal/observations.h"

namespace hdr {
namespace {

constexpr int kPlaces = 24000;
constexpr int kFirst = 232;  ///< from here up medians are taken; up to the fit's last code they show that they agree
constexpr double kBinWidth = 0.02, kReach = 1.2;  ///< of ln light above g(kFirst)
constexpr double kMedianDeviation = 0.03;         ///< ln, of a median
constexpr std::int64_t kFewestInBin = 60;
constexpr int kDarkestReference = 50, kBrightestReference = 200;  ///< codes of the shorter shot that measure well

using CodeHistogram = std::array<std::int64_t, 256>;

/// histogram[b]: the codes that longer shots gave to light of bin b.
std::vector<CodeHistogram> histograms(const std::vector<int>& codes, const Eigen::VectorXd& ln_exposure,
                                      const std::vector<double>& g) {
  const auto shots = static_cast<std::size_t>(ln_exposure.size());
  std::vector<CodeHistogram> bins(static_cast<std::size_t>(kReach / kBinWidth));
  for (std::size_t j = 0; j < shots; ++j) {
    for (std::size_t k = j + 1; k < std::min(shots, j + 3); ++k) {
      const double longer = ln_exposure[static_cast<Eigen::Index>(k)] - ln_exposure[static_cast<Eigen::Index>(j)];
      for (std::size_t i = 0; i * shots < codes.size(); ++i) {
        const int reference = codes[i * shots + j], code = codes[i * shots + k];
        if (reference < kDarkestReference || reference > kBrightestReference || code < 0) continue;
        const double above = g[static_cast<std::size_t>(reference)] + longer - g[kFirst];
        const auto bin = static_cast<std::size_t>(std::max(0.0, above) / kBinWidth);
        if (above >= 0 && bin < bins.size()) ++bins[bin][static_cast<std::size_t>(code)];
      }
    }
  }
  return bins;
}

/// Pixels spread evenly over the cells of their codes.
double median_code(const CodeHistogram& histogram, std::int64_t count) {
  const double half = 0.5 * static_cast<double>(count);
  double below = 0;
  int code = 0;
  while (below + static_cast<double>(histogram[static_cast<std::size_t>(code)]) < half) {
    below += static_cast<double>(histogram[static_cast<std::size_t>(code++)]);
  }
  return code - 0.5 + (half - below) / static_cast<double>(histogram[static_cast<std::size_t>(code)]);
}

struct Median {
  double ln_light, code;
};

std::vector<Median> medians(const std::vector<CodeHistogram>& bins, double origin) {
  std::vector<Median> found;
  for (std::size_t b = 0; b < bins.size(); ++b) {
    std::int64_t count = 0;
    for (const std::int64_t n : bins[b]) count += n;
    if (count < kFewestInBin) break;  // a gap ends what is known
    const double code = std::max(median_code(bins[b], count), found.empty() ? 0.0 : found.back().code);
    found.push_back({origin + (static_cast<double>(b) + 0.5) * kBinWidth, code});
    if (code > 254) break;  // the last cell: any more light
  }
  return found;
}

/// ln light at which the median reaches `code`; NaN beyond what is known.
double ln_light_at(const std::vector<Median>& curve, double code) {
  for (std::size_t k = 1; k < curve.size(); ++k) {
    if (!(curve[k - 1].code <= code && code < curve[k].code)) continue;
    const double t = (code - curve[k - 1].code) / (curve[k].code - curve[k - 1].code);
    return curve[k - 1].ln_light + t * (curve[k].ln_light - curve[k - 1].ln_light);
  }
  return NAN;
}

/// The parabola through g(last - span .. last), least squares, at `code`.
double parabola_at(const std::vector<double>& g, int last, int span, double code) {
  Eigen::MatrixXd powers(span + 1, 3);
  Eigen::VectorXd values(span + 1);
  for (int k = 0; k <= span; ++k) {
    const double x = k - span;
    powers.row(k) << 1, x, x * x;
    values[k] = g[static_cast<std::size_t>(last - span + k)];
  }
  const Eigen::Vector3d c = powers.colPivHouseholderQr().solve(values);
  const double x = code - last;
  return c[0] + c[1] * x + c[2] * x * x;
}

void measure_channel(const std::vector<int>& codes, const Eigen::VectorXd& ln_exposure, int last_fitted,
                     int last_measured, const std::vector<double>& deviation, std::vector<double>& g) {
  const std::vector<Median> curve = medians(histograms(codes, ln_exposure, g), g[kFirst]);
  // Where both are known they differ by what the choice of pixels does.
  double apart = 0, count = 0;
  for (int code = kFirst + 4; code <= last_fitted; ++code) {
    const double measured = ln_light_at(curve, code);
    if (std::isnan(measured)) continue;
    apart += measured - g[static_cast<std::size_t>(code)];
    ++count;
  }
  if (count < 5) return;
  apart /= count;
  int last = last_fitted;
  while (last < last_measured && !std::isnan(ln_light_at(curve, last + 1))) ++last;
  if (last < last_fitted + 3) return;  // too little to be better than what smoothness says
  std::vector<double> measured = g;
  for (int code = last_fitted + 1; code <= last; ++code) {
    measured[static_cast<std::size_t>(code)] = ln_light_at(curve, code) - apart;
  }
  constexpr int kSpan = 12;
  const double step = measured[static_cast<std::size_t>(last)] - parabola_at(measured, last, kSpan, last);
  for (int code = last + 1; code <= 255; ++code) {
    measured[static_cast<std::size_t>(code)] = parabola_at(measured, last, kSpan, code) + step;
  }
  for (int code = last_fitted + 1; code <= 255; ++code) {
    const auto at = static_cast<std::size_t>(code);
    const double doubt = deviation[at] * deviation[at], trust = doubt / (doubt + kMedianDeviation * kMedianDeviation);
    g[at] = std::max(g[at - 1], g[at] + trust * (measured[at] - g[at]));
  }
}

}  // namespace

internal::CodesAtPlaces top_places(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo) {
  return {bracket, ref_from_photo, internal::jittered_places(bracket.size(), kPlaces)};
}

void measure_top_codes(const Bracket& bracket, const Eigen::VectorXd& ln_exposure, const internal::CodesAtPlaces& seen,
                       const std::array<std::vector<double>, 3>& deviation, Response& response) {
  if (response.bits != 8) return;
  const std::array<std::vector<int>, 3>& codes = seen.codes();
  const bool lossy = std::any_of(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.lossy; });
  const int last_fitted = static_cast<int>(usable_codes(response.bits, lossy).highest);
  // Compression's errors are cut off at 255, and pull down the median of what is within three codes of it.
  const int last_measured = lossy ? 251 : 254;
  for (std::size_t c = 0; c < 3; ++c)
    measure_channel(codes[c], ln_exposure, last_fitted, last_measured, deviation[c], response.g[c]);
}

}  // namespace hdr
