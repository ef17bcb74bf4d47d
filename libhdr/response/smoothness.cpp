#include "libhdr/response/internal/smoothness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/response/internal/debevec_malik.h"
#include "libhdr/response/internal/knots.h"

namespace hdr {
namespace {

constexpr int kFolds = 3;
constexpr double kGrid[] = {1e-3, 1e-2, 1e-1, 1, 10};
constexpr double kShoulders[] = {INFINITY, 0.25};
constexpr double kTolerance = 1.15;
constexpr int kShoulderCount = static_cast<int>(std::size(kShoulders));
constexpr int kGridSize = static_cast<int>(std::size(kGrid));

/// The squared residuals of held-out points: count, sum and sum of squares.
struct Score {
  double count = 0, sum = 0, squares = 0;
  void add(const Score& other) {
    count += other.count;
    sum += other.sum;
    squares += other.squares;
  }
  double mean() const { return sum / count; }
  double standard_error() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean()) / count); }
};

Score held_out_score(const Knots& knots, const Eigen::MatrixXd& codes, const Eigen::VectorXd& ln_exposure,
                     double smoothness) {
  std::vector<Eigen::Index> kept, held_out;
  for (Eigen::Index i = 0; i < codes.rows(); ++i) (i % kFolds == kFolds - 1 ? held_out : kept).push_back(i);
  Score score;
  if (kept.empty() || held_out.empty()) return score;
  const CurveFit fit = fit_curve(knots, codes(kept, Eigen::all), ln_exposure, smoothness);
  const Eigen::MatrixXd residuals = weighted_residuals(knots, fit.g, codes(held_out, Eigen::all), ln_exposure);
  for (const double r : residuals.reshaped()) {
    if (std::isnan(r)) continue;
    score.add({1, r * r, r * r * r * r});
  }
  return score;
}

/// scores[shoulder * kGridSize + k], all channels together.
std::vector<Score> cross_validate(int bits, const std::array<Eigen::MatrixXd, 3>& codes,
                                  const Eigen::VectorXd& ln_exposure) {
  std::vector<Knots> knots;
  for (const double shoulder : kShoulders) knots.emplace_back(bits, shoulder);
  std::vector<Score> parts(3 * kGridSize * kShoulderCount);
  for_rows(static_cast<int>(parts.size()), 1, [&](int first, int) {
    const int channel = first % 3, setting = first / 3;
    parts[static_cast<std::size_t>(first)] =
        held_out_score(knots[static_cast<std::size_t>(setting / kGridSize)], codes[static_cast<std::size_t>(channel)],
                       ln_exposure, kGrid[setting % kGridSize]);
  });
  std::vector<Score> scores(parts.size() / 3);
  for (std::size_t k = 0; k < parts.size(); ++k) scores[k / 3].add(parts[k]);
  return scores;
}

}  // namespace

SmoothnessChoice choose_smoothness(int bits, const std::array<Eigen::MatrixXd, 3>& codes,
                                   const Eigen::VectorXd& ln_exposure) {
  const std::vector<Score> scores = cross_validate(bits, codes, ln_exposure);
  const auto best = std::min_element(scores.begin(), scores.end(),
                                     [](const Score& a, const Score& b) { return a.mean() < b.mean(); });
  const double limit = std::max(kTolerance * best->mean(), best->mean() + best->standard_error());
  // The stiffest that the data admit; of two equally stiff, the one that predicts better.
  SmoothnessChoice choice{0, INFINITY};
  double chosen_mean = INFINITY;
  for (int setting = 0; setting < kGridSize * kShoulderCount; ++setting) {
    const double mean = scores[static_cast<std::size_t>(setting)].mean();
    const double smoothness = kGrid[setting % kGridSize];
    const bool stiffer = smoothness > choice.smoothness;
    if (mean > limit || !(stiffer || (smoothness == choice.smoothness && mean < chosen_mean))) continue;
    choice = {smoothness, kShoulders[setting / kGridSize]};
    chosen_mean = mean;
  }
  return choice;
}

}  // namespace hdr
