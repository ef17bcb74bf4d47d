#include "libhdr/response/internal/smoothness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/response/internal/curve_prior.h"
#include "libhdr/response/internal/debevec_malik.h"
#include "libhdr/response/internal/knots.h"
#include "libhdr/response/internal/normal_equations.h"

namespace hdr {
namespace {

constexpr int kFolds = 3;
constexpr double kGrid[] = {1e-3, 1e-2, 1e-1, 0.316, 1, 3.16, 10};
/// Ways to be smooth: without a shoulder, with one, and (the last, where there is one) in the distance from the prior.
constexpr double kShoulders[] = {INFINITY, 0.25, INFINITY};
constexpr int kWithPrior = 2;
constexpr double kLeastOfAmbiguous = 1;  ///< where steps are uniform; less lets in waves of .03 to .15
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

/// The scores of one channel with one shoulder, for each smoothness of the grid.
std::array<Score, kGridSize> held_out_scores(const Knots& knots, const CodeWeights& weights,
                                             const Eigen::MatrixXd& codes, const Eigen::VectorXd& ln_exposure,
                                             const Eigen::VectorXd& prior) {
  std::vector<Eigen::Index> kept, held_out;
  for (Eigen::Index i = 0; i < codes.rows(); ++i) (i % kFolds == kFolds - 1 ? held_out : kept).push_back(i);
  std::array<Score, kGridSize> scores;
  if (kept.empty() || held_out.empty()) return scores;
  const NormalEquations equations(knots, weights, codes(kept, Eigen::all), ln_exposure);
  const Eigen::MatrixXd judged = codes(held_out, Eigen::all);
  for (std::size_t k = 0; k < scores.size(); ++k) {
    const Eigen::MatrixXd residuals =
        weighted_residuals(knots, weights, equations.solve(kGrid[k], prior), judged, ln_exposure);
    for (const double r : residuals.reshaped()) {
      if (!std::isnan(r)) scores[k].add({1, r * r, r * r * r * r});
    }
  }
  return scores;
}

/// scores[shoulder * kGridSize + k], all channels together.
std::vector<Score> cross_validate(int bits, const std::array<CodeWeights, 3>& weights,
                                  const std::array<Eigen::MatrixXd, 3>& codes, const Eigen::VectorXd& ln_exposure,
                                  const std::array<Eigen::VectorXd, 3>& priors, int ways) {
  std::array<std::array<Score, kGridSize>, 3 * kShoulderCount> parts;
  for_rows(3 * ways, 1, [&](int part, int) {
    const Knots knots(bits, kShoulders[part / 3]);
    const auto channel = static_cast<std::size_t>(part % 3);
    parts[static_cast<std::size_t>(part)] =
        held_out_scores(knots, weights[channel], codes[channel], ln_exposure,
                        part / 3 == kWithPrior ? priors[channel] : Eigen::VectorXd{});
  });
  std::vector<Score> scores(kGridSize * kShoulderCount);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    for (std::size_t k = 0; k < kGridSize; ++k) scores[part / 3 * kGridSize + k].add(parts[part][k]);
  }
  return scores;
}

}  // namespace

SmoothnessChoice choose_smoothness(int bits, const std::array<CodeWeights, 3>& weights,
                                   const std::array<Eigen::MatrixXd, 3>& codes, const Eigen::VectorXd& ln_exposure,
                                   const std::array<Eigen::VectorXd, 3>& priors) {
  const bool any_prior = priors[0].size() + priors[1].size() + priors[2].size() > 0;
  const int ways = any_prior ? kShoulderCount : kWithPrior;
  const std::vector<Score> scores = cross_validate(bits, weights, codes, ln_exposure, priors, ways);
  const double least = ambiguous_step(ln_exposure) > 0 ? kLeastOfAmbiguous : 0;
  double best_mean = INFINITY, limit = INFINITY;
  for (int setting = 0; setting < kGridSize * ways; ++setting) {
    const Score& score = scores[static_cast<std::size_t>(setting)];
    if (kGrid[setting % kGridSize] < least || !(score.mean() < best_mean)) continue;
    best_mean = score.mean();
    limit = best_mean + score.standard_error();
  }
  // The stiffest that the data admit; of two equally stiff, the one that predicts better.
  SmoothnessChoice choice{0, INFINITY};
  double chosen_mean = INFINITY;
  for (int setting = 0; setting < kGridSize * ways; ++setting) {
    const double mean = scores[static_cast<std::size_t>(setting)].mean();
    const double smoothness = kGrid[setting % kGridSize];
    const bool stiffer = smoothness > choice.smoothness;
    if (smoothness < least || mean > limit || !(stiffer || (smoothness == choice.smoothness && mean < chosen_mean)))
      continue;
    choice = {smoothness, kShoulders[setting / kGridSize], setting / kGridSize == kWithPrior};
    chosen_mean = mean;
  }
  return choice;
}

}  // namespace hdr
