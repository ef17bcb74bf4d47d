#include "libhdr/align/internal/joint.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

namespace hdr::internal {
namespace {

constexpr double kPairOutlier = 3;  // standard deviations from which a pair's pull fades (Cauchy)

std::size_t index_of(MotionModel model) {
  return static_cast<std::size_t>(std::find(kMotionModels.begin(), kMotionModels.end(), model) - kMotionModels.begin());
}

/// One pair as a quadratic form of the motion between its shots: |root * vector(measured^-1 b_from_a)|^2.
struct Constraint {
  int a = 0, b = 0;
  Mat3 measured = Mat3::Identity();
  Eigen::MatrixXd root;  ///< rows x 8
};

/// A root of the inverse of a covariance.
Eigen::MatrixXd inverse_root(const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd c = covariance;
  c.diagonal().array() += 1e-12 * c.trace() + 1e-12;
  const Eigen::LLT<Eigen::MatrixXd> llt(c);
  return llt.matrixL().solve(Eigen::MatrixXd::Identity(c.rows(), c.cols()));
}

Constraint constraint_of(const MotionFrame& frame, const MeasuredPair& pair, MotionModel model) {
  const MotionModel used = unknowns(pair.motion.richest) < unknowns(model) ? pair.motion.richest : model;
  const Measurement& m = pair.motion.measured[index_of(used)];
  const int n = unknowns(used);
  Constraint c{pair.a, pair.b, pair.motion.b_from_a * frame.motion(m.step), {}};
  const Eigen::MatrixXd root = inverse_root(m.covariance.topLeftCorner(n, n));
  // A shift that was measured alone is that of what was compared, wherever the shots may turn.
  if (used == MotionModel::kTranslation) {
    c.root = root * frame.basis(pair.motion.middle);
    c.root.rightCols(kMotionUnknowns - unknowns(model)).setZero();
  } else {
    c.root = Eigen::MatrixXd::Zero(n, kMotionUnknowns);
    c.root.leftCols(n) = root;
  }
  return c;
}

class PairTerm {
 public:
  PairTerm(const MotionFrame& frame, Constraint constraint)
      : frame_(frame), constraint_(std::move(constraint)), from_measured_(constraint_.measured.inverse()) {}
  bool operator()(const double* const* places, double* residuals) const {
    using Vector = Eigen::Map<const MotionVector>;
    const Mat3 a = frame_.motion(Vector(places[0])), b = frame_.motion(Vector(places[1]));
    const Eigen::VectorXd r = constraint_.root * frame_.vector(from_measured_ * b * a.inverse());
    std::copy_n(r.data(), r.size(), residuals);
    return true;
  }

 private:
  const MotionFrame& frame_;
  Constraint constraint_;
  Mat3 from_measured_;
};

/// The unknowns of all shots, and the terms that tie them.
class JointProblem {
 public:
  JointProblem(const MotionFrame& frame, std::vector<MotionVector>& places, int reference, MotionModel model)
      : frame_(frame), places_(places), model_(model) {
    for (MotionVector& place : places_) {
      problem_.AddParameterBlock(place.data(), kMotionUnknowns);
      std::vector<int> held;
      for (int k = unknowns(model); k < kMotionUnknowns; ++k) held.push_back(k);
      if (!held.empty()) problem_.SetManifold(place.data(), new ceres::SubsetManifold(kMotionUnknowns, held));
    }
    problem_.SetParameterBlockConstant(places_[static_cast<std::size_t>(reference)].data());
  }

  void add(const Constraint& c, bool robust) {
    auto* cost = new ceres::DynamicNumericDiffCostFunction<PairTerm>(new PairTerm(frame_, c));
    cost->AddParameterBlock(kMotionUnknowns);
    cost->AddParameterBlock(kMotionUnknowns);
    cost->SetNumResiduals(static_cast<int>(c.root.rows()));
    if (robust) rows_ += static_cast<int>(c.root.rows());
    problem_.AddResidualBlock(cost, robust ? new ceres::CauchyLoss(kPairOutlier) : nullptr, block(c.a), block(c.b));
  }

  void solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    options.function_tolerance = 1e-10;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
  }

  /// Covariances of the places, the reference's zero, widened where the pairs differ by more than they claim.
  std::vector<MotionMatrix> covariances(int reference) {
    const int m = unknowns(model_);
    ceres::Problem::EvaluateOptions options;
    std::vector<int> shot_of;
    for (int k = 0; k < static_cast<int>(places_.size()); ++k) {
      if (k == reference) continue;
      options.parameter_blocks.push_back(block(k));
      shot_of.push_back(k);
    }
    std::vector<MotionMatrix> found(places_.size(), MotionMatrix::Zero());
    if (shot_of.empty()) return found;
    double cost = 0;
    ceres::CRSMatrix sparse;
    problem_.Evaluate(options, &cost, nullptr, nullptr, &sparse);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
    for (int row = 0; row < sparse.num_rows; ++row) {
      for (int i = sparse.rows[static_cast<std::size_t>(row)]; i < sparse.rows[static_cast<std::size_t>(row) + 1];
           ++i) {
        jacobian(row, sparse.cols[static_cast<std::size_t>(i)]) = sparse.values[static_cast<std::size_t>(i)];
      }
    }
    Eigen::MatrixXd information = jacobian.transpose() * jacobian;
    information.diagonal().array() += 1e-9;
    const Eigen::MatrixXd inverse =
        information.ldlt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
    const int spare = rows_ - static_cast<int>(shot_of.size()) * m;
    const double widened = spare > 0 ? std::max(1.0, 2 * cost / spare) : 1.0;
    for (std::size_t k = 0; k < shot_of.size(); ++k) {
      const auto first = static_cast<Eigen::Index>(k) * m;
      found[static_cast<std::size_t>(shot_of[k])].topLeftCorner(m, m) = widened * inverse.block(first, first, m, m);
    }
    return found;
  }

 private:
  double* block(int shot) { return places_[static_cast<std::size_t>(shot)].data(); }

  const MotionFrame& frame_;
  std::vector<MotionVector>& places_;
  MotionModel model_;
  ceres::Problem problem_;
  int rows_ = 0;  ///< of pairs
};

/// Root mean square of each unknown over the neighbours that were measured: how such a camera moves.
MotionVector typical_motion(const MotionFrame& frame, const std::vector<MeasuredPair>& pairs) {
  MotionVector squares = MotionVector::Zero();
  int good = 0;
  for (const MeasuredPair& pair : pairs) {
    if (!pair.good() || pair.b != pair.a + 1) continue;
    squares += frame.vector(pair.motion.b_from_a).cwiseAbs2();
    ++good;
  }
  return good > 0 ? MotionVector((squares / good).cwiseSqrt()) : MotionVector::Ones();
}

/// Starts of all shots along good pairs from the reference outwards; where none leads on, a shot lies where its
/// neighbour does, and `ties` says so.
std::vector<Mat3> chained(int shots, int reference, const std::vector<MeasuredPair>& pairs, std::map<int, int>& ties) {
  std::vector<Mat3> places(static_cast<std::size_t>(shots), Mat3::Identity());
  std::vector<bool> placed(static_cast<std::size_t>(shots), false);
  placed[static_cast<std::size_t>(reference)] = true;
  const auto spread = [&] {
    for (bool again = true; again;) {
      again = false;
      for (const MeasuredPair& pair : pairs) {
        const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
        if (!pair.good() || placed[a] == placed[b]) continue;
        if (placed[a]) places[b] = pair.motion.b_from_a * places[a];
        if (placed[b]) places[a] = pair.motion.b_from_a.inverse() * places[b];
        placed[a] = placed[b] = again = true;
      }
    }
  };
  spread();
  const auto tie = [&](int shot, int to) {
    if (placed[static_cast<std::size_t>(shot)]) return;
    places[static_cast<std::size_t>(shot)] = places[static_cast<std::size_t>(to)];
    placed[static_cast<std::size_t>(shot)] = true;
    ties[shot] = to;
    spread();
  };
  for (int k = reference + 1; k < shots; ++k) tie(k, k - 1);
  for (int k = reference - 1; k >= 0; --k) tie(k, k + 1);
  return places;
}

/// Why shot k hangs on a tie: the trouble of its pair with the neighbour that it was tied to.
std::string trouble_of(int shot, int to, const std::vector<MeasuredPair>& pairs) {
  for (const MeasuredPair& pair : pairs) {
    if (std::min(shot, to) == pair.a && std::max(shot, to) == pair.b) return pair.motion.trouble;
  }
  return "it was not compared";
}

double mean_inliers(int shot, const std::vector<MeasuredPair>& pairs) {
  double good = 0, sum = 0, best = 0;
  for (const MeasuredPair& pair : pairs) {
    if (pair.a != shot && pair.b != shot) continue;
    best = std::max(best, pair.motion.inliers);
    if (!pair.good()) continue;
    ++good;
    sum += pair.motion.inliers;
  }
  return good > 0 ? sum / good : best;
}

/// Keeps what the pictures do not say as small as it is elsewhere in the bracket.
Constraint prior(int a, int b, const MotionVector& typical, MotionModel model) {
  constexpr double kGenerous = 3, kLeast = 0.1;
  Constraint c{a, b, Mat3::Identity(), Eigen::MatrixXd::Zero(kMotionUnknowns - 2, kMotionUnknowns)};
  for (int k = 2; k < unknowns(model); ++k) c.root(k - 2, k) = 1 / std::max(kLeast, kGenerous * typical[k]);
  return c;
}

}  // namespace

MotionModel common_model(const std::vector<MeasuredPair>& pairs) {
  std::array<double, kMotionModels.size()> sums{};
  for (const MeasuredPair& pair : pairs) {
    if (!pair.good()) continue;
    const double last = pair.motion.costs[index_of(pair.motion.richest)];
    for (std::size_t k = 0; k < sums.size(); ++k) {
      sums[k] += std::isfinite(pair.motion.costs[k]) ? pair.motion.costs[k] : last;
    }
  }
  return cheapest(sums);
}

std::vector<Place> reconcile(const MotionFrame& frame, int shots, int reference,
                             const std::vector<MeasuredPair>& pairs) {
  const MotionModel model = common_model(pairs);
  std::map<int, int> ties;
  const std::vector<Mat3> starts = chained(shots, reference, pairs, ties);
  std::vector<MotionVector> vectors;
  for (const Mat3& start : starts) {
    vectors.push_back(frame.vector(start));
    vectors.back().tail(kMotionUnknowns - unknowns(model)).setZero();
  }
  const MotionVector typical = typical_motion(frame, pairs);
  JointProblem joint(frame, vectors, reference, model);
  for (const MeasuredPair& pair : pairs) {
    if (pair.good()) joint.add(constraint_of(frame, pair, model), true);
  }
  const bool turns = model != MotionModel::kTranslation;
  for (int k = 0; turns && k + 1 < shots; ++k) joint.add(prior(k, k + 1, typical, model), false);
  // A shot that could not be measured has moved as much as the others have: that is the doubt it adds.
  for (const auto& [shot, to] : ties) {
    Constraint tie{to, shot, Mat3::Identity(), Eigen::MatrixXd::Zero(2, kMotionUnknowns)};
    tie.root(0, 0) = tie.root(1, 1) = 1 / std::max(1e-3, typical.head<2>().norm() / std::sqrt(2.0));
    joint.add(tie, false);
  }
  joint.solve();
  const std::vector<MotionMatrix> covariances = joint.covariances(reference);
  std::vector<Place> places(static_cast<std::size_t>(shots));
  for (int k = 0; k < shots; ++k) {
    Place& place = places[static_cast<std::size_t>(k)];
    if (k != reference) place.photo_from_ref = frame.motion(vectors[static_cast<std::size_t>(k)]);
    place.error_px = frame.rms(covariances[static_cast<std::size_t>(k)]);
    place.inliers = mean_inliers(k, pairs);
    if (const auto tie = ties.find(k); tie != ties.end()) place.trouble = trouble_of(k, tie->second, pairs);
  }
  return places;
}

}  // namespace hdr::internal
