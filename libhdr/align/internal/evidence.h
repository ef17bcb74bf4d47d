#pragma once
// What the tiles of one linearisation say about the motion, under each model: the step, its covariance, and what the
// model costs against a richer one.
#include <array>
#include <utility>
#include <vector>

#include "libhdr/align/internal/gauss_newton.h"
#include "libhdr/align/internal/motion.h"

namespace hdr::internal {

/// The step of Gauss-Newton under one model; unknowns beyond the model's are 0.
struct Step {
  MotionVector motion = MotionVector::Zero();
  MotionMatrix covariance = MotionMatrix::Zero();
  KnotVector match = KnotVector::Zero();
  bool finite() const { return motion.allFinite() && match.allFinite() && covariance.allFinite(); }
};

class Evidence {
 public:
  Evidence(const MotionFrame& frame, const Linearization& at, const PhotometricMatch& match);

  /// Moves the match alone where `move` is false; the covariance is that of the motion all the same.
  Step step(MotionModel model, bool move = true) const;
  /// The motion under `model` that is nearest to another where the evidence lies.
  Mat3 nearest(const Mat3& motion, MotionModel model) const;
  /// Tiles of equal weight that would say as much.
  double effective_tiles() const { return effective_tiles_; }
  /// The richest model that has three tiles for each unknown.
  MotionModel richest() const;
  /// What an unknown must be worth, in chi^2: Schwarz's criterion [Schwarz78] with tiles as its observations.
  double price() const;
  /// For each of kMotionModels: how much worse than the richest it explains the pictures, as chi^2, plus the price of
  /// its unknowns. `so_far`: the motion of the linearisation. `floor`: error (pixels) that the tiles do not show.
  /// Infinite for models richer than richest().
  std::array<double, kMotionModels.size()> costs(const Mat3& so_far, double floor) const;

 private:
  static constexpr int kAll = kMotionUnknowns + kKnots;
  using Matrix = Eigen::Matrix<double, kAll, kAll>;
  using Vector = Eigen::Matrix<double, kAll, 1>;

  Vector add(const TileSums& tile, Matrix& hessian) const;

  MotionFrame frame_;
  Matrix hessian_ = Matrix::Zero();
  Vector score_ = Vector::Zero();
  KnotVector match_;
  std::vector<Vector> tile_scores_;
  std::vector<std::pair<Vec2, double>> tile_weights_;  ///< middle, and how much it says
  double effective_tiles_ = 0;
};

/// chi^2 of leaving out the unknowns from the `used`-th on of an estimate with this covariance; its size says how many
/// there are.
double cost_of_leaving_out(int used, const Eigen::VectorXd& estimate, const Eigen::MatrixXd& covariance);

/// The model of the least cost.
MotionModel cheapest(const std::array<double, kMotionModels.size()>& costs);

}  // namespace hdr::internal
