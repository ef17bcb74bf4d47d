// [Janesick07] Photon Transfer: variance against signal gives the gain (here: the full well) and the read noise.
#include "libhdr/response/estimate_noise.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/error.h"
#include "libhdr/core/median.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/response/internal/noise_of_codes.h"

namespace hdr {
namespace {

constexpr int kPlaces = 12000;
constexpr int kBinsAnOctave = 2, kOctaves = 20;  ///< of the level of the shorter shot
constexpr int kBins = kBinsAnOctave * kOctaves;
constexpr int kFewestInBin = 60;
constexpr double kHighestLevel = 0.9;  ///< of the longer shot: clear of clipping and of what compression does to it

/// One channel of a response in shares of full well: X(code) and the slope dX/dcode, tabulated.
struct LevelTable {
  LevelTable(const Response& response, int channel) {
    const int codes = 1 << response.bits;
    const double full_well = response.exposure(channel, codes - 1);
    for (int code = 0; code < codes; ++code) {
      level.push_back(response.exposure(channel, code) / full_well);
    }
    for (int code = 0; code < codes; ++code) {
      const int below = std::max(0, code - 1), above = std::min(codes - 1, code + 1);
      slope.push_back((level[static_cast<std::size_t>(above)] - level[static_cast<std::size_t>(below)]) /
                      (above - below));
    }
    black = response.black_code(channel);
  }
  std::vector<double> level, slope;
  int black = 0;
};

/// What one pair of shots says about the noise at one level: a variance, and how it depends on the model.
struct Measurement {
  double variance;      ///< of X_short - ratio X_long
  double count;         ///< samples behind it
  double per_electron;  ///< d variance / d(1 / full well)
  double per_read;      ///< d variance / d(read noise / full well)^2
  double per_code;      ///< d variance / d(code noise)^2
  double rounding;      ///< variance that rounding adds
  double beyond;        ///< samples farther than four robust deviations from their middle
};

/// Codes of one channel of all shots at the sampled places; -1 outside the frame. codes[i * shots + j]
using SampledCodes = std::vector<int>;

struct Residual {
  double value;
  double prediction;     ///< level of the shorter shot, from the longer one
  double slope_squares;  ///< slope_short^2 + ratio^2 slope_long^2
  bool black;            ///< the shorter shot's code says no light
};

/// Robust variance: the median of the sizes, which for a normal distribution is .6745 deviations. Where black cuts the
/// noise off below, only the residuals above the prediction are whole; elsewhere the centre is their own median, so
/// that a small error of the response is not taken for noise.
struct Spread {
  double variance = 0;  ///< 0: too few samples
  double beyond = 0;    ///< samples farther than four deviations
};
Spread robust_spread(const std::vector<Residual>& bin) {
  constexpr double kMedianOfNormal = 0.67449;
  const auto black = std::count_if(bin.begin(), bin.end(), [](const Residual& r) { return r.black; });
  const bool cut = static_cast<double>(black) > 0.005 * static_cast<double>(bin.size());
  std::vector<double> sizes;
  double centre = 0;
  if (!cut) {
    for (const Residual& r : bin) sizes.push_back(r.value);
    centre = median_of(sizes);
    sizes.clear();
  }
  for (const Residual& r : bin) {
    if (!cut || r.value > 0) sizes.push_back(std::abs(r.value - centre));
  }
  if (static_cast<int>(sizes.size()) < kFewestInBin / 4) return {};
  const double deviation = median_of(sizes) / kMedianOfNormal;
  const auto beyond = std::count_if(sizes.begin(), sizes.end(), [&](double size) { return size > 4 * deviation; });
  return {deviation * deviation,
          static_cast<double>(beyond) * static_cast<double>(bin.size()) / static_cast<double>(sizes.size())};
}

Measurement measurement_of(const std::vector<Residual>& bin, double ratio) {
  double prediction = 0, slope_squares = 0;
  for (const Residual& r : bin) {
    prediction += r.prediction;
    slope_squares += r.slope_squares;
  }
  const auto count = static_cast<double>(bin.size());
  prediction /= count;
  slope_squares /= count;
  // Shot noise: X_short has variance X / full well, and ratio X_long has ratio^2 (X / ratio) / full well. Each code was
  // rounded once by the camera, and spread over its cell once more by us.
  const Spread spread = robust_spread(bin);
  return {spread.variance,   count,        prediction * (1 + ratio), 1 + ratio * ratio, slope_squares,
          slope_squares / 6, spread.beyond};
}

/// All bins of the pair (shorter j, longer k).
void measure_pair(const SampledCodes& codes, std::size_t shots, std::size_t j, std::size_t k, double ratio,
                  const LevelTable& table, std::vector<Measurement>& out) {
  std::vector<std::vector<Residual>> bins(kBins);
  for (std::size_t i = 0; i * shots < codes.size(); ++i) {
    const int code_short = codes[i * shots + j], code_long = codes[i * shots + k];
    if (code_short < 0 || code_long < 0 || code_long <= table.black) continue;
    const auto s = static_cast<std::size_t>(code_short), l = static_cast<std::size_t>(code_long);
    if (table.level[l] > kHighestLevel) continue;
    const double prediction = ratio * table.level[l];
    const int bin = static_cast<int>(std::floor(kBins + kBinsAnOctave * std::log2(prediction)));
    if (bin < 0 || bin >= kBins) continue;
    // Spread over their cells, codes are continuous and have a median worth the name. By place and code, so that shots
    // which say nothing change nothing.
    Random random(i, static_cast<std::uint64_t>(code_short) << 16 | static_cast<std::uint64_t>(code_long));
    const double spread_short = random.uniform() - 0.5, spread_long = random.uniform() - 0.5;
    const double value =
        table.level[s] + spread_short * table.slope[s] - ratio * (table.level[l] + spread_long * table.slope[l]);
    bins[static_cast<std::size_t>(bin)].push_back(
        {value, prediction, table.slope[s] * table.slope[s] + ratio * ratio * table.slope[l] * table.slope[l],
         code_short <= table.black});
  }
  for (const std::vector<Residual>& bin : bins) {
    if (static_cast<int>(bin.size()) < kFewestInBin) continue;
    const Measurement m = measurement_of(bin, ratio);
    if (m.variance > 0) out.push_back(m);
  }
}

/// ln(measured / model), in units of the doubt of a variance; parameters ln(1/full well), ln(read/full well)^2 and
/// ln(code noise)^2.
struct VarianceTerm {
  Measurement m;
  template <class T>
  bool operator()(const T* electron, const T* read, const T* code, T* residual) const {
    const T model = ceres::exp(*electron) * m.per_electron + ceres::exp(*read) * m.per_read +
                    ceres::exp(*code) * m.per_code + m.rounding;
    // A variance from n medians has a relative deviation of about sqrt(5 / n); and no model is right within 10 %.
    residual[0] = (std::log(m.variance) - ceres::log(model)) / std::sqrt(5.0 / m.count + 0.01);
    return true;
  }
};

/// What is known of cameras before looking: weak, for brackets that say nothing.
struct Prior {
  double mean, deviation;
  template <class T>
  bool operator()(const T* value, T* residual) const {
    residual[0] = (*value - mean) / deviation;
    return true;
  }
};

NoiseModel fit_noise(const std::vector<Measurement>& measurements, bool lossy) {
  const NoiseModel usual;
  double electron = std::log(1 / usual.full_well), read = 2 * std::log(usual.read_noise / usual.full_well);
  constexpr double kUsualCodeNoise = 0.5;
  double code = 2 * std::log(kUsualCodeNoise);
  ceres::Problem problem;
  const auto add_prior = [&](double* value, double deviation) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior, 1, 1>(new Prior{*value, deviation}), nullptr,
                             value);
  };
  add_prior(&electron, 1.5);
  add_prior(&read, 3);
  add_prior(&code, 1.5);
  for (const Measurement& m : measurements) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<VarianceTerm, 1, 1, 1, 1>(new VarianceTerm{m}),
                             new ceres::CauchyLoss(3), &electron, &read, &code);
  }
  if (!lossy) {
    code = -100;  // nothing besides the rounding
    problem.SetParameterBlockConstant(&code);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  NoiseModel noise;
  noise.full_well = std::exp(-electron);
  noise.read_noise = std::exp(0.5 * read) * noise.full_well;
  noise.code_noise = lossy ? std::exp(0.5 * code) : 0;
  return noise;
}

}  // namespace

internal::CodesAtPlaces internal::noise_places(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo) {
  return {bracket, ref_from_photo, jittered_places(bracket.size(), kPlaces)};
}

NoiseEstimate estimate_noise(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo, const Response& response,
                             const std::vector<bool>& left_out, const std::vector<double>& exposures) {
  internal::CodesAtPlaces seen = internal::noise_places(bracket, ref_from_photo);
  seen.look_at(bracket);
  return internal::estimate_noise(bracket, seen, response, left_out, exposures);
}

NoiseEstimate internal::estimate_noise(const Bracket& bracket, const CodesAtPlaces& seen, const Response& response,
                                       const std::vector<bool>& left_out, const std::vector<double>& exposures) {
  HDR_ASSERT(response.bits == bracket.bits());
  const std::size_t shots = bracket.shots.size();
  HDR_ASSERT(left_out.empty() || left_out.size() == shots);
  const auto used = [&](std::size_t shot) { return left_out.empty() || !left_out[shot]; };
  HDR_ASSERT(exposures.empty() || exposures.size() == shots);
  const auto exposure = [&](std::size_t shot) {
    return exposures.empty() ? bracket.shots[shot].relative_exposure() : exposures[shot];
  };
  const std::array<SampledCodes, 3>& codes = seen.codes();
  const bool lossy = std::any_of(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.lossy; });
  NoiseEstimate estimate;
  std::array<double, 3> count{}, beyond{};
  for_rows(3, 1, [&](int channel, int) {
    const auto c = static_cast<std::size_t>(channel);
    const LevelTable table(response, channel);
    std::vector<Measurement> measurements;
    for (std::size_t j = 0; j < shots; ++j) {
      for (std::size_t k = j + 1; k < std::min(shots, j + 3); ++k) {
        if (!used(j) || !used(k)) continue;
        const double ratio = exposure(j) / exposure(k);
        measure_pair(codes[c], shots, j, k, ratio, table, measurements);
      }
    }
    estimate.noise[c] = fit_noise(measurements, lossy);
    for (const Measurement& m : measurements) {
      count[c] += m.count;
      beyond[c] += m.beyond;
    }
  });
  const double all = count[0] + count[1] + count[2];
  if (all > 0) estimate.outliers = (beyond[0] + beyond[1] + beyond[2]) / all;
  return estimate;
}

}  // namespace hdr
