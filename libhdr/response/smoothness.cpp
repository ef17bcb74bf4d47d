#include "libhdr/response/internal/smoothness.h"

#include <cmath>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/response/internal/debevec_malik.h"

namespace hdr {
namespace {

constexpr int kFolds = 3;
constexpr double kGrid[] = {1e-4, 1e-3, 1e-2, 1e-1, 1, 10, 100};
constexpr double kTolerance = 1.1;
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

}  // namespace

double choose_smoothness(const Knots& knots, const std::array<Eigen::MatrixXd, 3>& codes,
                         const Eigen::VectorXd& ln_exposure) {
  std::vector<Score> parts(3 * kGridSize);
  for_rows(static_cast<int>(parts.size()), 1, [&](int first, int last) {
    for (int k = first; k < last; ++k) {
      parts[static_cast<std::size_t>(k)] =
          held_out_score(knots, codes[static_cast<std::size_t>(k % 3)], ln_exposure, kGrid[k / 3]);
    }
  });
  std::vector<Score> scores(kGridSize);
  int best = 0;
  for (int s = 0; s < kGridSize; ++s) {
    Score& score = scores[static_cast<std::size_t>(s)];
    for (int c = 0; c < 3; ++c) score.add(parts[static_cast<std::size_t>(3 * s + c)]);
    if (score.mean() < scores[static_cast<std::size_t>(best)].mean()) best = s;
  }
  const Score& least = scores[static_cast<std::size_t>(best)];
  const double limit = std::max(kTolerance * least.mean(), least.mean() + least.standard_error());
  int chosen = best;
  for (int s = best; s < kGridSize; ++s) {
    if (scores[static_cast<std::size_t>(s)].mean() <= limit) chosen = s;
  }
  return kGrid[chosen];
}

}  // namespace hdr
