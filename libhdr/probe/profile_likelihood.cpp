#include "libhdr/probe/internal/profile_likelihood.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libhdr/probe/internal/whitened_squares.h"

namespace hdr::internal {
namespace {

/// What fraction of a sample's area, at distance u from it and beyond, lies on the far side. Bilinear reading of pixel
/// means sees a blur of deviation 1/2 pixel: a triangle of half-width sqrt(6) / 2.
double share_beyond(double u) {
  constexpr double kHalfWidth = 1.2247;
  const double t = std::clamp(u / kHalfWidth, -1.0, 1.0);
  return t < 0 ? 1 - 0.5 * (1 + t) * (1 + t) : 0.5 * (1 - t) * (1 - t);
}

/// Covariance of a profile's samples: a random walk from the rim to both sides (natural pictures' spectra fall as those
/// of random walks do), averaged over each sample's area.
Eigen::MatrixXd covariance(const Clock& clock, int half_window, double shift) {
  constexpr double kStep = 0.1;
  const int n = 2 * half_window + 1;
  const int steps = static_cast<int>((half_window + std::abs(shift) + 2) / kStep);
  // The walk's steps, each scaled by its deviation, as seen by each sample.
  Eigen::MatrixXd seen(n, 2 * steps + 5);
  for (int i = 0; i < n; ++i) {
    const double x = i - half_window - shift;  // positive outside
    for (int j = 0; j < steps; ++j) {
      const double from = j * kStep, to = from + kStep;
      const double inside = clock.outline ? std::sqrt(to) - std::sqrt(from) : clock.outside * kStep;
      seen(i, 2 * j) = std::sqrt(inside) * share_beyond(x + from + 0.5 * kStep);
      seen(i, 2 * j + 1) = std::sqrt(clock.outside * kStep) * share_beyond(from + 0.5 * kStep - x);
    }
    // No surprise at all: any level, a step, an even slope outside; without an outline an even bend throughout.
    seen(i, 2 * steps) = 100;
    seen(i, 2 * steps + 1) = clock.step * share_beyond(x);
    seen(i, 2 * steps + 2) = clock.outline ? 0.1 * std::max(x, 0.0) : 0.1 * x;
    seen(i, 2 * steps + 3) = clock.outline ? 0 : 0.02 * x * x;
    seen(i, 2 * steps + 4) = clock.outline ? 0 : 0.004 * x * x * x;
  }
  return seen * seen.transpose() + clock.noise * Eigen::MatrixXd::Identity(n, n);
}

}  // namespace

ProfileLikelihood::ProfileLikelihood(const Clock& clock, int half_window, double shift) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance(clock, half_window, shift));
  const Eigen::MatrixXd lower = factor.matrixL();
  half_log_determinant_ = lower.diagonal().array().log().sum();
  whitening_ = factor.matrixL().solve(Eigen::MatrixXd::Identity(lower.rows(), lower.cols())).cast<float>();
}

Eigen::ArrayXd ProfileLikelihood::operator()(const SampleRows& profiles, Eigen::Index count, double floor) const {
  Eigen::ArrayXf squares(profiles.cols());
  whitened_squares(whitening_.data(), static_cast<int>(whitening_.rows()), profiles.data(), profiles.cols(),
                   static_cast<int>(profiles.cols()), squares.data());
  return -0.5 * static_cast<double>(profiles.rows()) *
             (squares.head(count) + static_cast<float>(floor)).log().cast<double>() -
         half_log_determinant_;
}

std::vector<Clock> outline_clocks() {
  std::vector<Clock> result;
  for (const double outside : {1e-4, 1e-3, 1e-2, 0.1, 1.0}) {
    for (const double noise : {1e-4, 1e-2}) result.push_back({true, 0.5, outside, noise});
  }
  return result;
}

std::vector<ProfileLikelihood> other_likelihoods(int half_window, int range) {
  std::vector<ProfileLikelihood> result;
  const auto add = [&](double step, double wander, double noise, int shift) {
    result.emplace_back(Clock{false, step, wander, noise}, half_window, shift);
  };
  for (const double noise : {1e-3, 1e-1}) {
    for (const double wander : {1e-3, 1.0}) add(0, wander, noise, 0);
    for (int shift = -range; shift <= range; ++shift) {
      for (const double step : {3.0, 30.0}) add(step, 1, noise, shift);
    }
  }
  return result;
}

}  // namespace hdr::internal
