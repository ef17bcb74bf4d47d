#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libhdr/core/error.h"
#include "libhdr/core/median.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/ball_views.h"
#include "libhdr/probe/internal/ball_glimpse.h"
#include "libhdr/probe/internal/ball_sphere.h"
#include "libhdr/probe/internal/rotation_search.h"
#include "libhdr/probe/internal/same_pixels.h"
#include "libhdr/probe/internal/view_difference.h"

namespace hdr {
namespace {

constexpr double kLeastCorrelation = 0.35;  ///< of detail: other scenes stay below 0.2
constexpr double kMostInverseDistance = 0.7;
/// As far as far: 0 itself has no slope to its other side, and a fit that came there would stay.
constexpr double kLeastInverseDistance = 1e-4;

/// What is fitted of a view. A rotation is a small turn on top of a first one.
struct Unknowns {
  Mat3 first = Mat3::Identity();
  double turn[3] = {0, 0, 0};
  double log_gain = 0;
  double inverse_distance = 0;
  double outline[3] = {0, 0, 0};  ///< centre moved, radius grown, in radii

  MirrorBall ball(const MirrorBall& given) const {
    const bool far = inverse_distance <= 1.01 * kLeastInverseDistance;
    return internal::changed(given, far ? 0 : inverse_distance, {outline[0], outline[1], outline[2]});
  }
  Mat3 probe_from_view() const { return internal::turned(first, turn); }
};

/// Without evidence the camera is far.
struct FarAtFirst {
  bool operator()(const double* inverse_distance, double* residual) const {
    *residual = *inverse_distance / 0.3;
    return true;
  }
};

/// An outline that was found is right to about half a pixel.
struct WhereItWasFound {
  double radius_px;
  bool operator()(const double* outline, double* residual) const {
    constexpr double kDeviation = 0.5;
    for (int k = 0; k < 3; ++k) residual[k] = outline[k] * radius_px / kDeviation;
    return true;
  }
};

double pair_weight(const BallView& a, const BallView& b, const Vec3& dir_a, const Vec3& dir_b) {
  const double wa = internal::visibility(a, dir_a) * internal::nobody_there(a, dir_a);
  const double wb = internal::visibility(b, dir_b) * internal::nobody_there(b, dir_b);
  return wa * wb;
}

/// The view as registered so far.
BallView as_registered(const BallView& view, const Unknowns& u) {
  BallView result = view;
  result.ball = u.ball(view.ball);
  return result;
}

/// Keeps what is known of a view, and within reason what is not.
void constrain(ceres::Problem& problem, const BallView& view, Unknowns& u) {
  using ceres::FORWARD, ceres::NumericDiffCostFunction;
  if (view.outline_known) {
    problem.SetParameterBlockConstant(u.outline);
  } else {
    problem.AddResidualBlock(
        new NumericDiffCostFunction<WhereItWasFound, FORWARD, 3, 3>(new WhereItWasFound{view.ball.disc.r}), nullptr,
        u.outline);
  }
  if (view.distance_known) {
    problem.SetParameterBlockConstant(&u.inverse_distance);
  } else {
    problem.SetParameterLowerBound(&u.inverse_distance, 0, kLeastInverseDistance);
    problem.SetParameterUpperBound(&u.inverse_distance, 0, kMostInverseDistance);
    problem.AddResidualBlock(new NumericDiffCostFunction<FarAtFirst, FORWARD, 1, 1>(new FarAtFirst), nullptr,
                             &u.inverse_distance);
  }
}

using Pair = internal::ViewDifferences::Pair;

/// Directions that two views see well enough, scaled by the root of how well.
std::vector<Pair> pairs_of(const std::vector<BallView>& views, const std::vector<Unknowns>& unknowns, int directions) {
  constexpr double kLeastWeight = 0.02;
  std::vector<Pair> pairs;
  for (std::size_t j = 1; j < views.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      for (const Vec3& dir : internal::even_directions(directions)) {
        const double weight = pair_weight(views[i], views[j], unknowns[i].probe_from_view().transpose() * dir,
                                          unknowns[j].probe_from_view().transpose() * dir);
        if (weight >= kLeastWeight) pairs.push_back({i, j, dir, std::sqrt(weight)});
      }
    }
  }
  return pairs;
}

/// The deviation of a pair's difference, by the median: what is known of outlines and distances is weighed against it.
double deviation_of(const std::vector<Pair>& pairs, const std::vector<internal::LogView>& pictures,
                    const std::vector<Unknowns>& unknowns) {
  constexpr double kLeast = 0.005, kSigmaOfMedian = 1.4826;
  std::vector<double> differences;
  const auto look = [&](std::size_t k, const Vec3& dir) {
    const Unknowns& u = unknowns[k];
    return pictures[k].at(u.probe_from_view().transpose() * dir, u.inverse_distance,
                          {u.outline[0], u.outline[1], u.outline[2]});
  };
  for (const Pair& pair : pairs) {
    const auto a = look(pair.i, pair.dir), b = look(pair.j, pair.dir);
    if (a && b) differences.push_back(std::abs(*a + unknowns[pair.i].log_gain - *b - unknowns[pair.j].log_gain));
  }
  return differences.empty() ? 1 : std::max(kLeast, kSigmaOfMedian * median_of(differences));
}

/// One round of the fit, on pictures in which the balls have this radius.
void refine(const std::vector<BallView>& views, std::vector<Unknowns>& unknowns, double radius_px, int directions) {
  constexpr double kCauchy = 2.385;  // 95 % as good as least squares where nothing is an outlier [Holland77]
  std::vector<internal::LogView> pictures;
  for (const BallView& view : views) pictures.push_back(internal::log_view(view, radius_px));
  for (Unknowns& u : unknowns) {
    u.first = u.probe_from_view();
    std::fill_n(u.turn, 3, 0.0);
  }
  for (std::size_t k = 0; k < views.size(); ++k) {
    double& inverse = unknowns[k].inverse_distance;
    if (!views[k].distance_known) inverse = std::clamp(inverse, kLeastInverseDistance, kMostInverseDistance);
  }
  std::vector<BallView> seen;
  for (std::size_t k = 0; k < views.size(); ++k) seen.push_back(as_registered(views[k], unknowns[k]));
  std::vector<Pair> pairs = pairs_of(seen, unknowns, directions);
  if (pairs.empty()) return;
  const double deviation = deviation_of(pairs, pictures, unknowns);
  for (Pair& pair : pairs) pair.scale /= deviation;
  std::vector<internal::FittedView> fitted;
  for (Unknowns& u : unknowns) fitted.push_back({u.first, u.turn, &u.log_gain, &u.inverse_distance, u.outline});
  internal::ViewDifferences differences(std::move(fitted), pictures, std::move(pairs));
  ceres::Problem::Options shared;
  shared.evaluation_callback = &differences;
  ceres::Problem problem(shared);
  differences.add_to(problem, new ceres::CauchyLoss(kCauchy));
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!problem.HasParameterBlock(unknowns[k].turn)) continue;
    if (k == 0) {
      problem.SetParameterBlockConstant(unknowns[0].turn);
      problem.SetParameterBlockConstant(&unknowns[0].log_gain);
    }
    constrain(problem, views[k], unknowns[k]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 15;
  options.function_tolerance = 1e-5;
  options.num_threads = 1;  // sums in one order
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

/// Rms of ln(radiance) against the other views, where both see well; differences beyond three times the median count as
/// that: somebody stands there.
double overlap_rms(const std::vector<BallView>& views, const std::vector<Unknowns>& unknowns, std::size_t k) {
  constexpr int kDirections = 5000;
  constexpr double kLeastWeight = 0.05, kRadius = 60;
  const internal::LogView mine = internal::log_view(views[k], kRadius);
  std::vector<std::pair<double, double>> differences;  // size, weight
  for (std::size_t other = 0; other < views.size(); ++other) {
    if (other == k) continue;
    const internal::LogView theirs = internal::log_view(views[other], kRadius);
    for (const Vec3& dir : internal::even_directions(kDirections)) {
      const Vec3 dir_k = unknowns[k].probe_from_view().transpose() * dir;
      const Vec3 dir_other = unknowns[other].probe_from_view().transpose() * dir;
      const double weight = pair_weight(views[k], views[other], dir_k, dir_other);
      if (weight < kLeastWeight) continue;
      const auto a = mine.at(dir_k, 1 / views[k].ball.distance);
      const auto b = theirs.at(dir_other, 1 / views[other].ball.distance);
      if (a && b) differences.emplace_back(std::abs(*a + unknowns[k].log_gain - *b - unknowns[other].log_gain), weight);
    }
  }
  if (differences.empty()) return 0;
  std::sort(differences.begin(), differences.end());
  const double most = 3 * 1.4826 * differences[differences.size() / 2].first;
  double sum = 0, weights = 0;
  for (const auto& [size, weight] : differences) {
    sum += weight * std::min(size, most) * std::min(size, most);
    weights += weight;
  }
  return std::sqrt(sum / weights);
}

double detail_correlation(const BallView& a, const BallView& b, const Mat3& a_from_b) {
  constexpr int kWidth = 192, kDirections = 8000;
  const internal::SampledSphere here(internal::SphereMap(a, kWidth), internal::even_directions(kDirections));
  return here.correlation(internal::SphereMap(b, kWidth), a_from_b);
}

/// Log of the gain that brings view b to view a: the weighted median of their differences.
double first_log_gain(const BallView& a, const BallView& b, const Mat3& a_from_b) {
  const internal::LogView pa = internal::log_view(a, 30), pb = internal::log_view(b, 30);
  std::vector<double> differences;
  for (const Vec3& dir : internal::even_directions(1000)) {
    const Vec3 dir_b = a_from_b.transpose() * dir;
    if (pair_weight(a, b, dir, dir_b) < 0.05) continue;
    const auto va = pa.at(dir, 1 / a.ball.distance), vb = pb.at(dir_b, 1 / b.ball.distance);
    if (va && vb) differences.push_back(*va - *vb);
  }
  if (differences.empty()) return 0;
  std::nth_element(differences.begin(), differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2),
                   differences.end());
  return differences[differences.size() / 2];
}

/// A turn that may bring a view to one before it, on its own.
struct Hypothesis {
  std::size_t partner = 0;
  Mat3 partner_from_view = Mat3::Identity();
  double partner_inverse_distance = 0, inverse_distance = 0, log_gain = 0;
  double correlation = -1;  ///< of detail, when it was looked at closely
};

/// The two views alone, placed by a rough match as well as they can be at middle resolution.
Hypothesis looked_at(const BallView& partner, const BallView& view, const internal::RotationMatch& match) {
  const std::vector<BallView> pair{partner, view};
  std::vector<Unknowns> unknowns(2);
  unknowns[0].inverse_distance = 1 / match.distance_a;
  unknowns[1].inverse_distance = 1 / match.distance_b;
  unknowns[1].first = match.a_from_b;
  unknowns[1].log_gain = first_log_gain(partner, view, match.a_from_b);
  refine(pair, unknowns, 50, 1500);
  refine(pair, unknowns, 120, 6000);
  Hypothesis result;
  result.partner_from_view = unknowns[0].probe_from_view().transpose() * unknowns[1].probe_from_view();
  result.partner_inverse_distance = unknowns[0].inverse_distance;
  result.inverse_distance = unknowns[1].inverse_distance;
  result.log_gain = unknowns[1].log_gain;
  result.correlation = detail_correlation(as_registered(partner, unknowns[0]), as_registered(view, unknowns[1]),
                                          result.partner_from_view);
  return result;
}

/// How view k is turned against one of those before it: of the turns that agree best from afar, the one that still does
/// when it is looked at closely. `runner_up`: the correlation of the best other turn.
Hypothesis best_hypothesis(const std::vector<BallView>& views, std::size_t k, double& runner_up) {
  constexpr double kMayBe = 0.6;  // of the best rough correlation
  std::vector<std::pair<std::size_t, internal::RotationMatch>> matches;
  for (std::size_t i = 0; i < k; ++i) {
    for (const internal::RotationMatch& match : internal::match_rotations(views[i], views[k]))
      matches.emplace_back(i, match);
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const auto& a, const auto& b) { return a.second.correlation > b.second.correlation; });
  const std::size_t partner = matches.front().first;
  Hypothesis best;
  runner_up = -1;
  for (const auto& [i, match] : matches) {
    if (i != partner || match.correlation < kMayBe * matches.front().second.correlation) continue;
    Hypothesis h = looked_at(views[i], views[k], match);
    h.partner = i;
    runner_up = std::max(runner_up, std::min(h.correlation, best.correlation));
    if (h.correlation > best.correlation) best = h;
  }
  return best;
}

/// A camera whose distance is to be found looks at the middle of its picture, unless something else is said: a ball a
/// few degrees beside it shows other directions than one in it.
std::vector<BallView> with_axes(std::vector<BallView> views) {
  for (BallView& view : views) {
    if (!view.distance_known && !view.ball.principal)
      view.ball.principal = Vec2(0.5 * view.rgb.width(), 0.5 * view.rgb.height());
  }
  return views;
}

}  // namespace

std::vector<RegisteredView> register_ball_views(const std::vector<BallView>& given,
                                                const std::vector<std::string>& names) {
  const std::vector<BallView> views = with_axes(given);
  HDR_ASSERT(names.size() == views.size());
  std::vector<Unknowns> unknowns(views.size());
  std::vector<RegisteredView> result(views.size());
  for (std::size_t k = 0; k < views.size(); ++k) {
    unknowns[k].inverse_distance = 1 / views[k].ball.distance;
    if (k == 0) continue;
    for (std::size_t i = 0; i < k; ++i) {
      if (!internal::same_pixels(views[i].rgb, views[k].rgb)) continue;
      throw Error(fmt::format("{}: the same photograph as {}; give views from different sides, best 90 degrees apart",
                              names[k], names[i]));
    }
    const Hypothesis best = best_hypothesis(views, k, result[k].runner_up);
    unknowns[k].first = unknowns[best.partner].first * best.partner_from_view;
    unknowns[k].inverse_distance = best.inverse_distance;
    if (k == 1) unknowns[0].inverse_distance = best.partner_inverse_distance;
    unknowns[k].log_gain = unknowns[best.partner].log_gain + best.log_gain;
  }
  if (views.size() > 2) {  // two were turned and placed that well on their own
    refine(views, unknowns, 50, 1500);
    refine(views, unknowns, 120, 6000);
  }
  refine(views, unknowns, 280, 40000);

  std::vector<BallView> fitted;
  for (std::size_t k = 0; k < views.size(); ++k) fitted.push_back(as_registered(views[k], unknowns[k]));
  for (std::size_t k = 0; k < views.size(); ++k) {
    double correlation = k == 0 ? 1 : -1;
    for (std::size_t i = 0; i < k; ++i) {
      correlation = std::max(
          correlation, detail_correlation(fitted[i], fitted[k],
                                          unknowns[i].probe_from_view().transpose() * unknowns[k].probe_from_view()));
    }
    if (correlation < kLeastCorrelation) {
      throw Error(
          fmt::format("{}: does not show what {} shows (correlation {:.2f}); give views of one ball in one place, "
                      "less than 150 degrees apart, or check --ball",
                      names[k], names[0], correlation));
    }
    result[k] = {unknowns[k].probe_from_view(),
                 std::exp(unknowns[k].log_gain),
                 fitted[k].ball,
                 overlap_rms(fitted, unknowns, k),
                 correlation,
                 result[k].runner_up};
  }
  return result;
}

}  // namespace hdr
