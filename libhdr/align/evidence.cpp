#include "libhdr/align/internal/evidence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace hdr::internal {
namespace {

using Dense = Eigen::MatrixXd;

/// Knots that few pixels speak for follow their neighbours in a straight line: a faint penalty on second differences.
Eigen::Matrix<double, kKnots, kKnots> bending_penalty(double trace) {
  const double strength = 1e-4 * trace + 1e-12;
  Eigen::Matrix<double, kKnots, kKnots> penalty = Eigen::Matrix<double, kKnots, kKnots>::Zero();
  for (int k = 0; k + 2 < kKnots; ++k) {
    KnotVector bend = KnotVector::Zero();
    bend.segment<3>(k) = Vec3(1, -2, 1);
    penalty += strength * bend * bend.transpose();
  }
  return penalty;
}

/// The unknowns of one model among all: its first `m`, and the knots.
std::vector<int> chosen(int m) {
  std::vector<int> all;
  for (int k = 0; k < m; ++k) all.push_back(k);
  for (int k = 0; k < kKnots; ++k) all.push_back(kMotionUnknowns + k);
  return all;
}

}  // namespace

Evidence::Evidence(const MotionFrame& frame, const Linearization& at, const PhotometricMatch& match)
    : frame_(frame), match_(match.value) {
  double weights = 0, squares = 0;
  tile_scores_.reserve(at.tiles.size());
  for (const TileSums& tile : at.tiles) {
    tile_scores_.push_back(add(tile, hessian_));
    score_ += tile_scores_.back();
    const double weight = tile.xx + tile.yy;
    weights += weight;
    squares += weight * weight;
    tile_weights_.emplace_back(tile.middle, weight);
  }
  effective_tiles_ = squares > 0 ? weights * weights / squares : 0;
}

/// Adds the tile to a Hessian; its score.
Evidence::Vector Evidence::add(const TileSums& tile, Matrix& hessian) const {
  // Within a tile the displacement is taken for that of its middle.
  const MotionBasis b = frame_.basis(tile.middle);
  Eigen::Matrix2d h;
  h << tile.xx, tile.xy, tile.xy, tile.yy;
  Eigen::Matrix<double, 2, kKnots> cross;
  for (int k = 0; k < kKnots; ++k) {
    const auto i = static_cast<std::size_t>(k);
    cross.col(k) = Vec2(tile.x_knot[i], tile.y_knot[i]);
    hessian(kMotionUnknowns + k, kMotionUnknowns + k) += tile.knot[i];
    if (k + 1 == kKnots) continue;
    hessian(kMotionUnknowns + k, kMotionUnknowns + k + 1) += tile.next_knot[i];
    hessian(kMotionUnknowns + k + 1, kMotionUnknowns + k) += tile.next_knot[i];
  }
  const Eigen::Matrix<double, kMotionUnknowns, kKnots> mixed = b.transpose() * cross;
  hessian.topLeftCorner<kMotionUnknowns, kMotionUnknowns>() += b.transpose() * h * b;
  hessian.topRightCorner<kMotionUnknowns, kKnots>() += mixed;
  hessian.bottomLeftCorner<kKnots, kMotionUnknowns>() += mixed.transpose();
  Vector score;
  score << b.transpose() * tile.shift_score, tile.knot_score;
  return score;
}

Step Evidence::step(MotionModel model, bool move) const {
  const int m = unknowns(model), n = m + kKnots;
  const std::vector<int> used = chosen(m);
  Dense h = hessian_(used, used);
  const double trace = h.diagonal().tail<kKnots>().sum();
  const auto penalty = bending_penalty(trace);
  h.bottomRightCorner<kKnots, kKnots>() += penalty;
  Eigen::VectorXd slope = score_(used);
  slope.tail<kKnots>() += penalty * match_;
  // A trace of regularisation keeps a constant picture solvable: its motion is then 0, its error huge.
  h.diagonal().head(m).array() += 1e-9 * h.diagonal().head(m).sum() / m + 1e-12;
  h.diagonal().tail<kKnots>().array() += 1e-9 * trace + 1e-12;
  const Dense inverse = h.ldlt().solve(Dense::Identity(n, n));
  // The sandwich of [White80] with tiles as its independent observations: H^-1 (sum s s^t) H^-1. Honest about noise
  // that neighbours share, moved content and an approximate response alike, since it uses the residuals that are there.
  Step step;
  Dense meat = Dense::Zero(m, m);
  for (const Vector& s : tile_scores_) {
    const Eigen::VectorXd pull = inverse.topRows(m) * s(used);
    meat += pull * pull.transpose();
  }
  const double spare = std::max(1.0, effective_tiles_ - 0.5 * m) / std::max(1.0, effective_tiles_);
  step.covariance.topLeftCorner(m, m) = meat / spare;
  const Eigen::VectorXd whole = -(inverse * slope);
  if (move) {
    step.motion.head(m) = whole.head(m);
    step.match = whole.tail<kKnots>();
    return step;
  }
  // With the motion held, its rows and columns leave the system; what it would have moved is part of its doubt.
  step.covariance.topLeftCorner(m, m) += whole.head(m) * whole.head(m).transpose();
  const Dense knots = h.bottomRightCorner<kKnots, kKnots>();
  step.match = -knots.ldlt().solve(slope.tail<kKnots>());
  return step;
}

Mat3 Evidence::nearest(const Mat3& motion, MotionModel model) const {
  const int m = unknowns(model);
  Dense normal = Dense::Zero(m, m);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(m);
  for (const auto& [middle, weight] : tile_weights_) {
    const Dense b = frame_.basis(middle).leftCols(m);
    normal += weight * b.transpose() * b;
    right += weight * b.transpose() * (moved(motion, middle) - middle);
  }
  normal.diagonal().array() += 1e-9 * normal.trace() + 1e-12;
  MotionVector found = MotionVector::Zero();
  found.head(m) = normal.ldlt().solve(right);
  return frame_.motion(found);
}

MotionModel Evidence::richest() const {
  MotionModel richest = MotionModel::kTranslation;
  for (const MotionModel model : kMotionModels) {
    if (effective_tiles_ >= 3.0 * unknowns(model)) richest = model;
  }
  return richest;
}

std::array<double, kMotionModels.size()> Evidence::costs(const Mat3& so_far, double floor) const {
  std::array<double, kMotionModels.size()> costs;
  costs.fill(std::numeric_limits<double>::infinity());
  const MotionModel full = richest();
  const int m = unknowns(full);
  const Step best = step(full);
  // The motion as the richest model has it: what is so far, and its step.
  MotionVector total = frame_.vector(so_far);
  total.head(m) += best.motion.head(m);
  Dense doubt = best.covariance.topLeftCorner(m, m);
  doubt.diagonal().array() += floor * floor;
  for (std::size_t k = 0; k < kMotionModels.size(); ++k) {
    const int used = unknowns(kMotionModels[k]);
    if (used > m) break;
    costs[k] = price() * used;
    if (best.finite()) costs[k] += cost_of_leaving_out(used, total.head(m), doubt);
  }
  return costs;
}

double Evidence::price() const {
  return std::log(std::max(2.0, effective_tiles_));
}

double cost_of_leaving_out(int used, const Eigen::VectorXd& estimate, const Eigen::MatrixXd& covariance) {
  const Eigen::Index left = estimate.size() - used;
  if (left <= 0) return 0;
  const Eigen::VectorXd refused = estimate.tail(left);
  return refused.dot(covariance.bottomRightCorner(left, left).ldlt().solve(refused));
}

MotionModel cheapest(const std::array<double, kMotionModels.size()>& costs) {
  return kMotionModels[static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin())];
}

}  // namespace hdr::internal
