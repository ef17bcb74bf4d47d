#include "capture/brightness.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

constexpr int kKnots = 25;
constexpr double kSlope = 1.9, kSlopeDeviation = 0.6;
/// Per square root of a unit of x, how much the slope of g wanders: sRGB's goes from 1 in its toe to 2.3 within 2
/// units.
constexpr double kSlopeWander = 0.5;
constexpr int kQuantiles = 32;
/// Quantiles of one pair of frames share flicker, drift and the shutter's own error: they are no more than this many
/// independent observations.
constexpr double kIndependent = 6;
constexpr double kPairDeviation = 0.03;  ///< of a shutter and of the light between two frames, natural log
constexpr double kRounding = 0.3;        ///< of a code
constexpr double kFewestSamples = 32;

}  // namespace

/// Codes of equal light.
struct BrightnessModel::Pairs {
  std::vector<double> a, b;
};

BrightnessModel::BrightnessModel(const UsableCodes& usable) : usable_(usable) {
  const double range = usable.white - usable.black;
  // Between the noise floor and this, codes still tell which of two exposures is the longer, if not how bright a pixel
  // is.
  darkest_ = usable.black + std::max(4.0, (usable.floor - usable.black) / 3);
  first_x_ = std::log((darkest_ - usable.black) / range);
  spacing_ = -first_x_ / (kKnots - 1);
  precision_ = Eigen::MatrixXd::Zero(kKnots, kKnots);
  right_ = Eigen::VectorXd::Zero(kKnots);
  const auto add = [this](const Eigen::VectorXd& row, double value, double deviation) {
    precision_ += row * row.transpose() / (deviation * deviation);
    right_ += row * (value / (deviation * deviation));
  };
  Eigen::VectorXd row = Eigen::VectorXd::Zero(kKnots);
  row[kKnots - 1] = 1;  // g is relative: nought at the largest code
  add(row, 0, 1e-3);
  row[0] = -1;
  add(row, kSlope * -first_x_, kSlopeDeviation * -first_x_);
  for (int k = 1; k + 1 < kKnots; ++k) {
    row.setZero();
    row[k - 1] = row[k + 1] = 1;
    row[k] = -2;
    add(row, 0, kSlopeWander * std::pow(spacing_, 1.5));
  }
  solve();
}

void BrightnessModel::solve() {
  const Eigen::LLT<Eigen::MatrixXd> factors(precision_);
  values_ = factors.solve(right_);
  covariance_ = factors.solve(Eigen::MatrixXd::Identity(kKnots, kKnots));
}

double BrightnessModel::x_of(double code) const {
  return std::log(std::max(code - usable_.black, 0.5) / (usable_.white - usable_.black));
}

Eigen::VectorXd BrightnessModel::weights_of(double code) const {
  const double place = std::clamp((x_of(code) - first_x_) / spacing_, 0.0, static_cast<double>(kKnots - 1));
  const int below = std::min(static_cast<int>(place), kKnots - 2);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(kKnots);
  weights[below] = 1 - (place - below);
  weights[below + 1] = place - below;
  return weights;
}

double BrightnessModel::ln_exposure(double code) const {
  return usable_.linear ? x_of(code) : weights_of(code).dot(values_);
}

std::optional<BrightnessModel::Pairs> BrightnessModel::pairs(const Appearance& a, const Appearance& b) const {
  const CodeHistogram &codes_a = a.green(), &codes_b = b.green();
  const double from = std::max(codes_a.share_below(darkest_), codes_b.share_below(darkest_));
  const double to = 1 - std::max(codes_a.share_above(usable_.ceiling), codes_b.share_above(usable_.ceiling));
  const double samples = static_cast<double>(std::min(codes_a.total, codes_b.total));
  if (!((to - from) * samples >= kFewestSamples)) return std::nullopt;
  Pairs pairs;
  for (int k = 0; k < kQuantiles; ++k) {
    const double q = from + (to - from) * (k + 0.5) / kQuantiles;
    pairs.a.push_back(codes_a.quantile(q));
    pairs.b.push_back(codes_b.quantile(q));
  }
  return pairs;
}

std::optional<BrightnessModel::Ratio> BrightnessModel::ratio(const Appearance& a, const Appearance& b) const {
  const std::optional<Pairs> found = pairs(a, b);
  if (!found) return std::nullopt;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(kKnots);
  double sum = 0, sum_of_values = 0, sum_of_squares = 0, rounding = 0;
  for (int k = 0; k < kQuantiles; ++k) {
    const double code_a = found->a[static_cast<std::size_t>(k)], code_b = found->b[static_cast<std::size_t>(k)];
    const double error = kSlope * kRounding / std::max(std::min(code_a, code_b) - usable_.black, 1.0);
    const double weight = 1 / (error * error + kPairDeviation * kPairDeviation);
    const double value = ln_exposure(code_b) - ln_exposure(code_a);
    mean += weight * (weights_of(code_b) - weights_of(code_a));
    sum += weight;
    sum_of_values += weight * value;
    sum_of_squares += weight * value * value;
    rounding += weight * error * error;
  }
  mean /= sum;
  Ratio ratio;
  ratio.ln_ratio = sum_of_values / sum;
  const double spread = std::max(0.0, sum_of_squares / sum - ratio.ln_ratio * ratio.ln_ratio);
  const double of_response = usable_.linear ? 0 : mean.dot(covariance_ * mean);
  ratio.deviation = std::sqrt(of_response + (spread + rounding / sum) / kIndependent + kPairDeviation * kPairDeviation);
  return ratio;
}

void BrightnessModel::learn(const Appearance& a, const Appearance& b, double ln_ratio) {
  if (usable_.linear) return;
  const std::optional<Pairs> found = pairs(a, b);
  if (!found) return;
  for (int k = 0; k < kQuantiles; ++k) {
    const double code_a = found->a[static_cast<std::size_t>(k)], code_b = found->b[static_cast<std::size_t>(k)];
    const double error = kSlope * kRounding / std::max(std::min(code_a, code_b) - usable_.black, 1.0);
    const double weight = kIndependent / kQuantiles / (error * error + kPairDeviation * kPairDeviation);
    const Eigen::VectorXd row = weights_of(code_b) - weights_of(code_a);
    precision_ += weight * row * row.transpose();
    right_ += weight * ln_ratio * row;
  }
  solve();
}

}  // namespace hdr
