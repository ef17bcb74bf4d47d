#include "libhdr/align/internal/joint.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace hdr::internal {
namespace {

constexpr double kPairOutlier = 3;  // standard deviations from which a pair's pull fades (Cauchy)

std::size_t index_of(MotionModel model) {
  return static_cast<std::size_t>(std::find(kMotionModels.begin(), kMotionModels.end(), model) - kMotionModels.begin());
}

const MeasuredPair* pair_of(int a, int b, const std::vector<MeasuredPair>& pairs) {
  const auto found =
      std::find_if(pairs.begin(), pairs.end(), [&](const MeasuredPair& p) { return p.a == a && p.b == b; });
  return found == pairs.end() ? nullptr : &*found;
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

/// What a richer estimate is when its unknowns from the n-th on must be zero: the conditional mean and covariance.
void condition(Eigen::VectorXd& estimate, Eigen::MatrixXd& covariance, int n) {
  const Eigen::Index left = estimate.size() - n;
  const Eigen::MatrixXd gain =
      covariance.bottomRightCorner(left, left).ldlt().solve(covariance.bottomLeftCorner(left, n));
  estimate = (estimate.head(n) - gain.transpose() * estimate.tail(left)).eval();
  covariance = (covariance.topLeftCorner(n, n) - gain.transpose() * covariance.bottomLeftCorner(left, n)).eval();
}

Constraint constraint_of(const MotionFrame& frame, const MeasuredPair& pair, MotionModel model) {
  const PairMotion& motion = pair.motion;
  const MotionModel used = std::min(motion.richest, model);
  const int n = unknowns(used);
  const Measurement& m = motion.measured[index_of(std::max(used, std::min(motion.model, motion.richest)))];
  Constraint c{pair.a, pair.b, motion.b_from_a * frame.motion(m.step), Eigen::MatrixXd::Zero(n, kMotionUnknowns)};
  Eigen::MatrixXd covariance = m.covariance.topLeftCorner(n, n);
  if (unknowns(motion.model) > n && unknowns(motion.richest) > n) {
    const int all = unknowns(std::min(motion.model, motion.richest));
    Eigen::VectorXd estimate = frame.vector(c.measured).head(all);
    covariance = m.covariance.topLeftCorner(all, all);
    condition(estimate, covariance, n);
    MotionVector conditioned = MotionVector::Zero();
    conditioned.head(n) = estimate;
    c.measured = frame.motion(conditioned);
  }
  const Eigen::MatrixXd root = inverse_root(covariance);
  // A shift that was measured alone is that of what was compared, wherever the shots may turn.
  if (used == MotionModel::kTranslation && model != used) {
    c.root = root * frame.basis(motion.middle);
  } else {
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

/// Three motions around a loop must be none. What is left beyond their covariances is what no covariance knows of:
/// detail that moves by itself, a lens that breathes, compression. Its variance, for each unknown of one pair.
MotionVector unmodelled_variance(const MotionFrame& frame, const std::vector<MeasuredPair>& pairs) {
  MotionVector sum = MotionVector::Zero(), loops = MotionVector::Zero();
  for (const MeasuredPair& over : pairs) {
    if (over.b != over.a + 2 || !over.good()) continue;
    const MeasuredPair *first = pair_of(over.a, over.a + 1, pairs), *second = pair_of(over.a + 1, over.b, pairs);
    if (first == nullptr || second == nullptr || !first->good() || !second->good()) continue;
    const MotionModel model = std::min({over.motion.richest, first->motion.richest, second->motion.richest});
    const auto motion = [&](const MeasuredPair& pair) -> Mat3 {
      return pair.motion.b_from_a * frame.motion(pair.motion.measured[index_of(model)].step);
    };
    const MotionVector closure = frame.vector(motion(over).inverse() * motion(*second) * motion(*first));
    for (int k = 0; k < unknowns(model); ++k) {
      sum[k] += closure[k] * closure[k];
      for (const MeasuredPair* pair : {&over, first, second}) {
        sum[k] -= pair->motion.measured[index_of(model)].covariance(k, k);
      }
      loops[k] += 1;
    }
  }
  return (sum.array() / (3 * loops.array().max(1))).max(0);
}

/// Medians of the unknowns over the neighbours that measured them: how such a camera moves.
MotionVector typical_motion(const MotionFrame& frame, const std::vector<MeasuredPair>& pairs) {
  MotionVector typical = MotionVector::Ones();
  for (int k = 0; k < kMotionUnknowns; ++k) {
    std::vector<double> moves;
    for (const MeasuredPair& pair : pairs) {
      if (!pair.good() || pair.b != pair.a + 1 || unknowns(pair.motion.richest) <= k) continue;
      moves.push_back(std::abs(frame.vector(pair.motion.b_from_a)[k]));
    }
    if (moves.empty()) continue;
    const auto middle = moves.begin() + static_cast<std::ptrdiff_t>(moves.size() / 2);
    std::nth_element(moves.begin(), middle, moves.end());
    typical[k] = *middle / 0.6745;  // the deviation of a normal distribution with this median magnitude
  }
  return typical;
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

/// The pair of shot k with the neighbour that it was tied to; a pair rather that knows its doubt.
const MeasuredPair* pair_in_trouble(int shot, int to, const std::vector<MeasuredPair>& pairs) {
  for (const MeasuredPair& pair : pairs) {
    if ((pair.a == shot || pair.b == shot) && pair.motion.doubt_px > 0) return &pair;
  }
  return pair_of(std::min(shot, to), std::max(shot, to), pairs);
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

/// How far a pair lies from the solution: root mean square over what was compared.
double disagreement(const MeasuredPair& pair, const std::vector<Place>& places) {
  const Mat3 solved = places[static_cast<std::size_t>(pair.b)].photo_from_ref *
                      places[static_cast<std::size_t>(pair.a)].photo_from_ref.inverse();
  double squares = 0;
  for (int k = 0; k < 4; ++k) {
    const Vec2 p = pair.motion.middle + (k < 2 ? 1 : -1) * std::numbers::sqrt2 * pair.motion.spread.col(k % 2);
    squares += (moved(solved, p) - moved(pair.motion.b_from_a, p)).squaredNorm() / 4;
  }
  return std::sqrt(squares);
}

/// The median over the pairs of a shot.
double disagreement(int shot, const std::vector<Place>& places, const std::vector<MeasuredPair>& pairs) {
  std::vector<double> apart;
  for (const MeasuredPair& pair : pairs) {
    if (pair.good() && (pair.a == shot || pair.b == shot)) apart.push_back(disagreement(pair, places));
  }
  if (apart.empty()) return 0;
  std::sort(apart.begin(), apart.end());
  return 0.5 * (apart[apart.size() / 2] + apart[(apart.size() - 1) / 2]);
}

/// Keeps what the pictures do not say as small as it is elsewhere in the bracket.
Constraint prior(int a, int b, const MotionVector& typical, MotionModel model) {
  constexpr double kLeast = 0.1;
  Constraint c{a, b, Mat3::Identity(), Eigen::MatrixXd::Zero(kMotionUnknowns - 2, kMotionUnknowns)};
  for (int k = 2; k < unknowns(model); ++k) c.root(k - 2, k) = 1 / std::max(kLeast, typical[k]);
  return c;
}

/// A camera that turns or is carried moves its picture by more than it deforms it: by the square of (half the diagonal
/// over the focal length). What is deformed without having moved is film, or a lens, or compression at the ends of the
/// scale, and another shot will not be deformed as this one is.
bool camera_could_have(const MotionFrame& frame, const std::vector<MeasuredPair>& pairs) {
  double moved = 0, deformed = 0;
  for (const MeasuredPair& pair : pairs) {
    if (!pair.good() || pair.b != pair.a + 1 || pair.motion.richest <= MotionModel::kRigid) continue;
    const Measurement& best = pair.motion.measured[index_of(pair.motion.richest)];
    MotionVector rigid = frame.vector(pair.motion.b_from_a * frame.motion(best.step)), rest = rigid;
    rigid.tail<kMotionUnknowns - 3>().setZero();
    rest.head<3>().setZero();
    moved += std::pow(frame.rms_between(frame.motion(rigid), Mat3::Identity()), 2);
    deformed += std::pow(frame.rms_between(frame.motion(rest), Mat3::Identity()), 2);
  }
  return deformed <= moved;
}

MotionModel cheaper_rigid(const std::array<double, kMotionModels.size()>& costs) {
  return costs[1] < costs[0] ? MotionModel::kRigid : MotionModel::kTranslation;
}

}  // namespace

MotionModel common_model(const MotionFrame& frame, const std::vector<MeasuredPair>& pairs) {
  const MotionVector unmodelled = unmodelled_variance(frame, pairs);
  std::array<double, kMotionModels.size()> sums{};
  for (const MeasuredPair& pair : pairs) {
    if (!pair.good()) continue;
    const int m = unknowns(pair.motion.richest);
    const Measurement& best = pair.motion.measured[index_of(pair.motion.richest)];
    Eigen::MatrixXd doubt = best.covariance.topLeftCorner(m, m);
    doubt.diagonal() += unmodelled.head(m);
    const MotionVector estimate = frame.vector(pair.motion.b_from_a * frame.motion(best.step));
    // A pair says nothing about unknowns that it could not measure, and pays for none.
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const int used = std::min(m, unknowns(kMotionModels[k]));
      sums[k] += pair.motion.price * used + cost_of_leaving_out(used, estimate.head(m), doubt);
    }
  }
  const MotionModel model = cheapest(sums);
  return model > MotionModel::kRigid && !camera_could_have(frame, pairs) ? cheaper_rigid(sums) : model;
}

std::vector<Place> reconcile(const MotionFrame& frame, int shots, int reference,
                             const std::vector<MeasuredPair>& pairs) {
  const MotionModel model = common_model(frame, pairs);
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
  // A shot that could not be measured has moved as much as the others have, and one that contradicts them is farther
  // off than was looked: that is the doubt it adds.
  for (const auto& [shot, to] : ties) {
    const MeasuredPair* pair = pair_in_trouble(shot, to, pairs);
    double doubt = typical.head<2>().norm() / std::numbers::sqrt2;
    if (pair != nullptr && pair->motion.doubt_px > 0) doubt = pair->motion.doubt_px / std::numbers::sqrt2;
    Constraint tie{to, shot, Mat3::Identity(), Eigen::MatrixXd::Zero(2, kMotionUnknowns)};
    tie.root(0, 0) = tie.root(1, 1) = 1 / std::max(1e-3, doubt);
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
    if (const auto tie = ties.find(k); tie != ties.end()) {
      const MeasuredPair* pair = pair_in_trouble(k, tie->second, pairs);
      place.trouble = pair != nullptr ? pair->motion.trouble : "it was not compared";
    }
  }
  for (int k = 0; k < shots; ++k) {
    double& error = places[static_cast<std::size_t>(k)].error_px;
    if (k != reference) error = std::hypot(error, disagreement(k, places, pairs));
  }
  return places;
}

}  // namespace hdr::internal
