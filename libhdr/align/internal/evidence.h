#pragma once
// What the tiles of one linearisation say about the motion, under each model: the step, its covariance, and what the
// model costs against a richer one.
#include <array>

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
  /// Tiles of equal weight that would say as much.
  double effective_tiles() const { return effective_tiles_; }
  /// The richest model that has three tiles for each unknown.
  MotionModel richest() const;
  /// For each of kMotionModels: how much worse than the richest it explains the pictures, as chi^2, plus the price of
  /// its unknowns: Schwarz's criterion [Schwarz78] with tiles as its observations. `so_far`: the motion of the
  /// linearisation. `floor`: error (pixels) that the tiles do not show. Infinite for models richer than richest().
  std::array<double, kMotionModels.size()> costs(const Mat3& so_far, double floor) const;

 private:
  static constexpr int kAll = kMotionUnknowns + kKnots;
  using Matrix = Eigen::Matrix<double, kAll, kAll>;
  using Vector = Eigen::Matrix<double, kAll, 1>;

  MotionFrame frame_;
  Matrix hessian_ = Matrix::Zero();
  Vector score_ = Vector::Zero();
  KnotVector match_;
  std::vector<Vector> tile_scores_;
  double effective_tiles_ = 0;
};

/// The index of the least cost.
MotionModel cheapest(const std::array<double, kMotionModels.size()>& costs);

}  // namespace hdr::internal
