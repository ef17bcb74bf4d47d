// Bundle adjustment of two lenses [Triggs00]: every match is a direction, which both photographs show where their lens
// puts it.
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/overlap_ring.h"

namespace hdr::internal {
namespace {

/// Centre and focal length (pixels a radian) of one lens; k1, k2 of [Kannala06] are common to both.
using LensParameters = std::array<double, 3>;

struct Observation {
  Vec2 px;
  Vec3 dir, t, b;       ///< the first guess of the direction, and tangents there
  Mat3 view_from_pair;  ///< the guess

  template <class T>
  bool operator()(const T* lens, const T* k, const T* turn, const T* offset, T* residual) const {
    const Eigen::Matrix<T, 3, 1> d = dir.cast<T>() + t.cast<T>() * offset[0] + b.cast<T>() * offset[1];
    const Eigen::Matrix<T, 3, 1> guess = view_from_pair.cast<T>() * d;
    T seen[3];
    ceres::AngleAxisRotatePoint(turn, guess.data(), seen);
    const T across = ceres::sqrt(seen[0] * seen[0] + seen[1] * seen[1]);
    const T theta = ceres::atan2(across, seen[2]), theta2 = theta * theta;
    const T radius = lens[2] * theta * (1.0 + theta2 * (k[0] + theta2 * k[1]));
    residual[0] = lens[0] - radius * seen[0] / across - px.x();
    residual[1] = lens[1] - radius * seen[1] / across - px.y();
    return true;
  }
};

/// A parameter is expected at a value, within a deviation.
struct Expectation {
  int index;
  double value, deviation;
  template <class T>
  bool operator()(const T* parameter, T* residual) const {
    residual[0] = (parameter[index] - value) / deviation;
    return true;
  }
};

/// An ideal lens as centre, focal length, k1, k2: least squares of the radius over its field.
void kannala_of(const Fisheye& lens, LensParameters& parameters, double (&k)[2]) {
  const double most = 0.5 * lens.fov_degrees * kDegree;
  const double scale = lens.disc.r / lens.radius_from_angle(most);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int n = 1; n <= 64; ++n) {
    const double theta = most * n / 64, t2 = theta * theta;
    const Eigen::Vector3d row(theta, theta * t2, theta * t2 * t2);
    normal += row * row.transpose();
    right += row * (scale * lens.radius_from_angle(theta));
  }
  const Eigen::Vector3d fit = normal.ldlt().solve(right);
  parameters = {lens.disc.cx, lens.disc.cy, fit[0]};
  k[0] = fit[1] / fit[0];
  k[1] = fit[2] / fit[0];
}

/// The field stays what it was; the disc is where the lens has it.
Fisheye lens_of(const LensParameters& parameters, const double (&k)[2], double fov_degrees) {
  Fisheye lens{{parameters[0], parameters[1], 1}, fov_degrees, Lens::kKannalaBrandt, {k[0], k[1], 0, 0}};
  lens.disc.r = parameters[2] * lens.radius_from_angle(0.5 * fov_degrees * kDegree);
  return lens;
}

}  // namespace

double fit_pair(const std::vector<Match>& matches, FisheyePair& pair) {
  constexpr double kCentrePx = 0.004, kLens = 0.01;  // the image circle's middle is no more than near
  std::array<LensParameters, 2> lenses;
  double k[2], other_k[2];
  kannala_of(pair.views[1].lens, lenses[1], other_k);
  kannala_of(pair.views[0].lens, lenses[0], k);
  std::array<std::array<double, 3>, 2> turns{};
  std::vector<std::array<double, 2>> offsets(matches.size());

  // A wide loss first, so that a guess some degrees off is drawn in by most matches, then ever less for outliers.
  const double disc_radius = pair.views[0].lens.disc.r;
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::LossFunctionWrapper loss(new ceres::CauchyLoss(1), ceres::TAKE_OWNERSHIP);
  ceres::Problem problem(ownership);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Match& m = matches[i];
    Vec3f t, b;
    tangents_from_normal(m.dir.cast<float>(), t, b);
    for (std::size_t v = 0; v < 2; ++v) {
      auto* cost = new ceres::AutoDiffCostFunction<Observation, 2, 3, 2, 3, 2>(
          new Observation{v == 0 ? m.front : m.back, m.dir, t.cast<double>(), b.cast<double>(),
                          pair.views[v].probe_from_view.transpose()});
      problem.AddResidualBlock(cost, &loss, lenses[v].data(), k, turns[v].data(), offsets[i].data());
    }
  }
  problem.SetParameterBlockConstant(turns[0].data());  // the first view sets the axes
  for (std::size_t v = 0; v < 2; ++v) {
    for (int c = 0; c < 2; ++c) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Expectation, 1, 3>(new Expectation{
                                   c, lenses[v][static_cast<std::size_t>(c)], kCentrePx * pair.views[v].lens.disc.r}),
                               nullptr, lenses[v].data());
    }
  }
  for (int c = 0; c < 2; ++c) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Expectation, 1, 2>(new Expectation{c, k[c], kLens / (1 + 2 * c)}), nullptr, k);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-9;
  options.num_threads = 1;  // the same sums whatever --threads
  options.logging_type = ceres::SILENT;
  auto* order = new ceres::ParameterBlockOrdering;
  for (auto& offset : offsets) order->AddElementToGroup(offset.data(), 0);
  for (std::size_t v = 0; v < 2; ++v) {
    order->AddElementToGroup(lenses[v].data(), 1);
    order->AddElementToGroup(turns[v].data(), 1);
  }
  order->AddElementToGroup(k, 1);
  options.linear_solver_ordering.reset(order);
  for (const double share : {0.05, 0.02, 0.008, 0.003, 0.0013}) {  // of the image circle's radius
    loss.Reset(new ceres::CauchyLoss(std::max(1.0, share * disc_radius)), ceres::TAKE_OWNERSHIP);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
  }

  for (std::size_t v = 0; v < 2; ++v) {
    pair.views[v].lens = lens_of(lenses[v], k, pair.views[v].lens.fov_degrees);
    Mat3 turn;
    ceres::AngleAxisToRotationMatrix(turns[v].data(), ceres::ColumnMajorAdapter3x3(turn.data()));
    pair.views[v].probe_from_view = (turn * pair.views[v].probe_from_view.transpose()).transpose();
  }
  // What is left: the two directions of each match, without what is near and so seen from two places.
  std::vector<double> angles;
  for (const Match& m : matches) {
    const auto p = pair.views[0].lens.dir_from_px(m.front), q = pair.views[1].lens.dir_from_px(m.back);
    if (!p || !q) continue;
    const Vec3 d = pair.views[0].probe_from_view * *p, e = pair.views[1].probe_from_view * *q;
    angles.push_back(std::atan2(d.cross(e).norm(), d.dot(e)));
  }
  if (angles.empty()) return kPi;
  std::sort(angles.begin(), angles.end());
  const double median = angles[angles.size() / 2];
  double squares = 0;
  int inliers = 0;
  for (const double angle : angles) {
    if (angle > 3 * median) break;
    squares += angle * angle;
    ++inliers;
  }
  return std::sqrt(squares / std::max(1, inliers));
}

}  // namespace hdr::internal
