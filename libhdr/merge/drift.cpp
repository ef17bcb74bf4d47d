#include "libhdr/merge/drift.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libhdr/core/median.h"
#include "libhdr/merge/internal/ghost_cells.h"

namespace hdr {
namespace {

using internal::CellPicture;

constexpr float kDarkest = 0.02f, kBrightest = 0.8f;  ///< levels of a well-exposed cell
constexpr std::size_t kFewest = 100;                  ///< cells behind a median
constexpr int kBlocks = 8;                            ///< a side: cells of one block may err alike, blocks do not
constexpr double kLeastDeviation = 1e-3;              ///< of a median, ln: no response is better known

/// ln radiance of shot a over that of shot b.
struct Ratio {
  std::size_t a = 0, b = 0;
  double ln = 0, variance = 1;
};

/// Variance of the median of values that err alike within a block: that of its influence, summed by blocks [Hampel74],
/// as the sandwich of [White80] does for means. The density at the median is that of a normal distribution.
double variance_of_median(const std::vector<double>& values, const std::vector<std::size_t>& blocks, double median) {
  std::vector<double> away, pull(kBlocks * kBlocks), touched(kBlocks * kBlocks);
  for (std::size_t k = 0; k < values.size(); ++k) {
    away.push_back(std::abs(values[k] - median));
    pull[blocks[k]] += values[k] > median ? 1 : values[k] < median ? -1 : 0;
    touched[blocks[k]] = 1;
  }
  const double deviation = 1.4826 * median_of(away);
  const double density = 1 / (std::sqrt(2 * std::numbers::pi) * std::max(deviation, 1e-9));
  double squares = 0, count = 0;
  for (std::size_t k = 0; k < pull.size(); ++k) {
    squares += pull[k] * pull[k];
    count += touched[k];
  }
  const double spare = std::max(0.5, (count - 1) / count);
  return squares / spare / std::pow(2 * density * static_cast<double>(values.size()), 2);
}

std::optional<Ratio> ratio_of(std::size_t a, std::size_t b, const std::vector<CellPicture>& pictures, Size cells,
                              double ln_step) {
  const auto well = [](float level) { return level >= kDarkest && level <= kBrightest; };
  std::vector<double> values;
  std::vector<std::size_t> blocks;
  const CellPicture &p = pictures[a], &q = pictures[b];
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const auto cell =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(cells.width) + static_cast<std::size_t>(x);
      if (p.flags[cell] | q.flags[cell]) continue;
      const float level_a = p.level[3 * cell + 1], level_b = q.level[3 * cell + 1];  // green
      if (!well(level_a) || !well(level_b)) continue;
      values.push_back(std::log(level_a / level_b) - ln_step);
      blocks.push_back(static_cast<std::size_t>(y * kBlocks / cells.height * kBlocks + x * kBlocks / cells.width));
    }
  }
  if (values.size() < kFewest) return std::nullopt;
  std::vector<double> sorted = values;
  const double median = median_of(sorted);
  return Ratio{a, b, median, variance_of_median(values, blocks, median) + kLeastDeviation * kLeastDeviation};
}

/// The largest group of shots that are joined by ratios; of equals, the darkest. Rising.
std::vector<std::size_t> joined(std::size_t shots, const std::vector<Ratio>& ratios) {
  std::vector<std::size_t> group(shots);
  for (std::size_t k = 0; k < shots; ++k) group[k] = k;
  for (const Ratio& r : ratios) {
    const std::size_t from = std::max(group[r.a], group[r.b]), to = std::min(group[r.a], group[r.b]);
    std::replace(group.begin(), group.end(), from, to);
  }
  std::vector<std::vector<std::size_t>> groups(shots);
  for (std::size_t k = 0; k < shots; ++k) groups[group[k]].push_back(k);
  const auto fewer = [](const auto& a, const auto& b) { return a.size() < b.size(); };
  const auto largest = std::max_element(groups.begin(), groups.end(), fewer);
  return largest == groups.end() ? std::vector<std::size_t>{} : *largest;
}

/// Least squares over the shots of the group (three or more): ln gains across to a constant and to ln exposure, and a
/// slope.
void solve(const std::vector<std::size_t>& members, const std::vector<Ratio>& ratios,
           const std::vector<double>& ln_exposure, std::vector<FrameGain>& gains) {
  const auto n = static_cast<Eigen::Index>(members.size());
  Eigen::VectorXd h(n);
  for (Eigen::Index k = 0; k < n; ++k) h(k) = ln_exposure[members[static_cast<std::size_t>(k)]];
  h.array() -= h.mean();
  const bool sloped = h.norm() > 1e-6;
  Eigen::MatrixXd fixed(n, sloped ? 2 : 1);
  fixed.col(0).setOnes();
  if (sloped) fixed.col(1) = h;
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(fixed).householderQ();
  const Eigen::Index free = n - fixed.cols();
  Eigen::MatrixXd basis(n, free + (sloped ? 1 : 0));
  basis.leftCols(free) = q.rightCols(free);
  if (sloped) basis.col(free) = h;
  struct Tie {
    Eigen::Index i, j;
    double ln, variance;
  };
  std::vector<Tie> used;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const Ratio& r : ratios) {
    const auto a = std::find(members.begin(), members.end(), r.a), b = std::find(members.begin(), members.end(), r.b);
    if (a == members.end() || b == members.end()) continue;
    const Eigen::Index i = a - members.begin(), j = b - members.begin();
    const double weight = 1 / r.variance;
    used.push_back({i, j, r.ln, r.variance});
    normal(i, i) += weight;
    normal(j, j) += weight;
    normal(i, j) -= weight;
    normal(j, i) -= weight;
    right(i) += weight * r.ln;
    right(j) -= weight * r.ln;
  }
  const Eigen::MatrixXd covariance =
      (basis.transpose() * normal * basis).ldlt().solve(Eigen::MatrixXd::Identity(basis.cols(), basis.cols()));
  const Eigen::VectorXd found = covariance * (basis.transpose() * right);
  // Where the ratios contradict each other by more than they claim, all of them know less.
  const Eigen::VectorXd solved = basis * found;
  const double spare = static_cast<double>(used.size()) - static_cast<double>(basis.cols());
  double squares = 0;
  for (const Tie& t : used) squares += std::pow(t.ln - (solved(t.i) - solved(t.j)), 2) / t.variance;
  const double widened = spare > 0 ? std::max(1.0, squares / spare) : 1;
  const Eigen::MatrixXd across = basis.leftCols(free);
  const Eigen::VectorXd ln_gain = across * found.head(free);
  const Eigen::MatrixXd spread = widened * across * covariance.topLeftCorner(free, free) * across.transpose();
  for (Eigen::Index k = 0; k < n; ++k) {
    gains[members[static_cast<std::size_t>(k)]] = {std::exp(ln_gain(k)), std::sqrt(std::max(0.0, spread(k, k))), ""};
  }
}

}  // namespace

std::vector<FrameGain> estimate_drift(const Bracket& bracket, const Alignment& alignment, const Response& response,
                                      const std::vector<bool>& left_out) {
  HDR_ASSERT(alignment.frames.size() == bracket.shots.size());
  std::vector<FrameGain> gains(bracket.shots.size(), {1, {}, "left out of the merge"});
  const bool lossy = std::any_of(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.lossy; });
  const internal::MergeModel model =
      internal::make_merge_model(response, {lossy, WeightKind::kVariance, std::nullopt, {}, {}});
  const internal::CellGrid grid = internal::cell_grid(bracket.size());
  std::vector<std::unique_ptr<internal::Source>> sources;
  std::vector<std::size_t> shots;
  std::vector<double> ln_exposure;
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    if (!left_out.empty() && left_out[j]) continue;
    const double exposure = bracket.shots[j].relative_exposure();
    sources.push_back(std::make_unique<internal::Source>(bracket.shots[j], alignment.frames[j].ref_from_photo, model,
                                                         exposure, internal::band_height_of(grid)));
    shots.push_back(j);
    ln_exposure.push_back(std::log(exposure));
  }
  const std::vector<CellPicture> pictures = internal::cell_pictures(grid, model, sources);
  std::vector<Ratio> ratios;
  for (std::size_t b = 1; b < shots.size(); ++b) {
    for (std::size_t a = b < 2 ? 0 : b - 2; a < b; ++a) {
      if (const auto ratio = ratio_of(a, b, pictures, grid.cells, ln_exposure[a] - ln_exposure[b]))
        ratios.push_back(*ratio);
    }
  }
  const std::vector<std::size_t> members = joined(shots.size(), ratios);
  std::vector<FrameGain> found(shots.size(), {1, {}, "shares too few well-exposed cells with the other shots"});
  if (members.size() == 2) {
    for (const std::size_t k : members) found[k].unknown = "only two shots share well-exposed cells";
  }
  if (members.size() >= 3) solve(members, ratios, ln_exposure, found);
  for (std::size_t k = 0; k < shots.size(); ++k) gains[shots[k]] = found[k];
  return gains;
}

}  // namespace hdr
