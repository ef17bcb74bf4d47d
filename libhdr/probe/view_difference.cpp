#include "libhdr/probe/internal/view_difference.h"

#include <ceres/sized_cost_function.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "libhdr/core/parallel.h"
#include "libhdr/probe/internal/ball_glimpse.h"

namespace hdr::internal {
namespace {

/// One of the differences, as Ceres takes it. Blocks: turns of both views, log gains, inverse distances, outlines.
class OneDifference : public ceres::SizedCostFunction<1, 3, 3, 1, 1, 1, 1, 3, 3> {
 public:
  explicit OneDifference(const ViewDifferences::Difference& difference) : difference_(difference) {}

  bool Evaluate(double const* const*, double* residual, double** jacobians) const override {
    *residual = difference_.residual;
    for (std::size_t k = 0; jacobians && k < 2; ++k) {
      const ViewDifferences::Slopes& slopes = difference_.slopes[k];
      if (jacobians[k]) std::copy(slopes.turn.begin(), slopes.turn.end(), jacobians[k]);
      if (jacobians[2 + k]) *jacobians[2 + k] = slopes.log_gain;
      if (jacobians[4 + k]) *jacobians[4 + k] = slopes.inverse_distance;
      if (jacobians[6 + k]) std::copy(slopes.outline.begin(), slopes.outline.end(), jacobians[6 + k]);
    }
    return true;
  }

 private:
  const ViewDifferences::Difference& difference_;
};

}  // namespace

Mat3 turned(const Mat3& first, const double* turn) {
  const Vec3 v(turn[0], turn[1], turn[2]);
  const double angle = v.norm();
  return angle > 0 ? Mat3(Eigen::AngleAxisd(angle, v / angle).toRotationMatrix() * first) : first;
}

/// A view under the unknowns as they are.
struct ViewDifferences::Sight {
  Sight(const FittedView& view, const MirrorBall& ball)
      : before_first(turned(Mat3::Identity(), view.turn).transpose()),
        view_from_probe(view.first.transpose() * before_first),
        glimpses(ball, std::max(0.0, *view.inverse_distance), {view.outline[0], view.outline[1], view.outline[2]}) {}

  Mat3 before_first, view_from_probe;
  BallGlimpses glimpses;
};

ViewDifferences::ViewDifferences(std::vector<FittedView> views, const std::vector<LogView>& pictures,
                                 std::vector<Pair> pairs)
    : views_(std::move(views)), pairs_(std::move(pairs)), differences_(pairs_.size()) {
  for (const LogView& picture : pictures) {
    balls_.push_back(picture.ball);
    pictures_.emplace_back(picture.log_luminance);
  }
}

void ViewDifferences::add_to(ceres::Problem& problem, ceres::LossFunction* loss) {
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const FittedView &a = views_[pairs_[k].i], &b = views_[pairs_[k].j];
    problem.AddResidualBlock(new OneDifference(differences_[k]), loss, a.turn, b.turn, a.log_gain, b.log_gain,
                             a.inverse_distance, b.inverse_distance, a.outline, b.outline);
  }
}

std::vector<double> ViewDifferences::unknowns() const {
  std::vector<double> result;
  for (const FittedView& view : views_) {
    result.insert(result.end(), view.turn, view.turn + 3);
    result.insert(result.end(), {*view.log_gain, *view.inverse_distance});
    result.insert(result.end(), view.outline, view.outline + 3);
  }
  return result;
}

/// The slopes are nearly free once the places are known, and Ceres mostly asks for them after the residuals.
void ViewDifferences::PrepareForEvaluation(bool, bool) {
  constexpr int kGrain = 256;
  std::vector<double> here = unknowns();
  if (here == known_for_) return;
  std::vector<Sight> sights;
  for (std::size_t k = 0; k < views_.size(); ++k) sights.emplace_back(views_[k], balls_[k]);
  for_rows(static_cast<int>(pairs_.size()), kGrain, [&](int first, int last) {
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k)
      differences_[k] = difference_of(pairs_[k], sights);
  });
  known_for_ = std::move(here);
}

ViewDifferences::Difference ViewDifferences::difference_of(const Pair& pair, const std::vector<Sight>& sights) const {
  constexpr double kLeast = 1e-9;
  const std::array<std::size_t, 2> views{pair.i, pair.j};
  // Pixels from moves across the direction, in one basis for both.
  const Vec3 t = pair.dir.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> across;
  across << t, pair.dir.cross(t);
  std::array<Glimpse, 2> seen;
  std::array<Eigen::Matrix2d, 2> from_move;
  for (std::size_t k = 0; k < 2; ++k) {
    const Sight& sight = sights[views[k]];
    const auto glimpse = sight.glimpses(sight.view_from_probe * pair.dir);
    if (!glimpse || !pictures_[views[k]].holds(glimpse->px)) return {};
    seen[k] = *glimpse;
    from_move[k] = glimpse->px_from_dir * sight.view_from_probe * across;
    if (!(std::abs(from_move[k].determinant()) >= kLeast)) return {};
  }
  Difference result;
  for (std::size_t k = 0; k < 2; ++k) {
    const Sight& sight = sights[views[k]];
    const Glimpse& g = seen[k];
    const PatchMean light = pictures_[views[k]].mean(g.px, from_move[k] * from_move[1 - k].inverse());
    const double scale = k == 0 ? pair.scale : -pair.scale;
    const Vec2 slope = scale * light.slope;
    result.residual += scale * (light.value + *views_[views[k]].log_gain);
    Slopes& slopes = result.slopes[k];
    slopes.log_gain = scale;
    slopes.inverse_distance = slope.dot(g.px_from_inverse_distance);
    Eigen::Map<Eigen::RowVector3d>(slopes.outline.data()) = slope.transpose() * g.px_from_outline;
    // A turn v of the view moves the direction the other way: exp(-[v]) d changes by (d x e) dv.
    const Vec3 dir = sight.before_first * pair.dir;
    const Eigen::RowVector3d by_move = slope.transpose() * g.px_from_dir * views_[views[k]].first.transpose();
    Eigen::Map<Eigen::RowVector3d>(slopes.turn.data()) = by_move.cross(dir.transpose());
  }
  return result;
}

}  // namespace hdr::internal
