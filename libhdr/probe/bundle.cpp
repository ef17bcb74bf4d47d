// Bundle adjustment of photographs from one point [Triggs00]: every match is a direction, which both photographs show
// where their common lens puts it.
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/median.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/photo_links.h"

namespace hdr::internal {
namespace {

constexpr std::size_t kMostOfALink = 200;

/// lens: ln of the focal length, k1, k2. The pixel is relative to the middle, in units of the longer side.
struct Observation {
  Vec2 seen;
  Vec3 dir, t, b;  ///< the first guess of the direction, and tangents there
  Mat3 photo_from_probe;

  template <class T>
  bool operator()(const T* lens, const T* turn, const T* offset, T* residual) const {
    const Eigen::Matrix<T, 3, 1> d = dir.cast<T>() + t.cast<T>() * offset[0] + b.cast<T>() * offset[1];
    const Eigen::Matrix<T, 3, 1> guess = photo_from_probe.cast<T>() * d;
    T ray[3];
    ceres::AngleAxisRotatePoint(turn, guess.data(), ray);
    if (!(ray[2] > 1e-3)) return false;
    const T x = -ray[0] / ray[2], y = -ray[1] / ray[2], r2 = x * x + y * y;
    const T scale = ceres::exp(lens[0]) * (1.0 + r2 * (lens[1] + r2 * lens[2]));  // [Brown66]
    residual[0] = scale * x - seen.x();
    residual[1] = scale * y - seen.y();
    return true;
  }
};

struct Expectation {
  int index;
  double value, deviation;
  template <class T>
  bool operator()(const T* lens, T* residual) const {
    residual[0] = (lens[index] - value) / deviation;
    return true;
  }
};

Vec2 relative(const Vec2& px, Size size) {
  return (px - 0.5 * Vec2(size.width, size.height)) / longer_side(size);
}

struct Used {
  std::size_t link, match;
};

}  // namespace

BundleFit adjust(const std::vector<Size>& sizes, const std::vector<Features>& features,
                 const std::vector<PhotoLink>& links, bool distortion, double reach, Bundle& bundle) {
  double lens[3] = {std::log(bundle.lens.focal), bundle.lens.k1, bundle.lens.k2};
  std::vector<std::array<double, 3>> turns(sizes.size(), {0, 0, 0});
  std::vector<Used> used;
  for (std::size_t l = 0; l < links.size(); ++l) {
    if (!links[l].verified) continue;
    const std::size_t all = links[l].matches.size(), count = std::min(kMostOfALink, all);
    for (std::size_t k = 0; k < count; ++k) used.push_back({l, k * all / count});
  }
  std::vector<std::array<double, 2>> offsets(used.size(), {0, 0});
  const auto px_of = [&](const Used& u, int side) {
    const PhotoLink& link = links[u.link];
    const FeaturePair& pair = link.matches[u.match];
    const auto photo = static_cast<std::size_t>(side ? link.b : link.a);
    return std::pair{photo, features[photo].px[static_cast<std::size_t>(side ? pair.b : pair.a)]};
  };

  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::LossFunctionWrapper loss(new ceres::CauchyLoss(1), ceres::TAKE_OWNERSHIP);
  ceres::Problem problem(ownership);
  auto* order = new ceres::ParameterBlockOrdering;
  const Rectilinear unit = camera_of(bundle.lens, {1, 1});
  std::vector<bool> has_turn(sizes.size(), false);
  for (std::size_t i = 0; i < used.size(); ++i) {
    Vec3 dir = Vec3::Zero();
    for (int side = 0; side < 2; ++side) {
      const auto [photo, px] = px_of(used[i], side);
      const auto ray = Rectilinear{{4, 4}, unit.fov_degrees, unit.distortion}.dir_from_px(
          Vec2(2, 2) + 4 * relative(px, sizes[photo]));
      const Vec2 r = relative(px, sizes[photo]) / bundle.lens.focal;
      dir += bundle.probe_from_photo[photo] * ray.value_or(Vec3(-r.x(), -r.y(), 1).normalized());
    }
    dir.normalize();
    // A link that contradicts the others may put a match behind a camera, where it is nowhere.
    constexpr double kAhead = 0.05;
    bool ahead = true;
    for (int side = 0; side < 2; ++side) {
      const std::size_t photo = px_of(used[i], side).first;
      ahead &= bundle.probe_from_photo[photo].col(2).dot(dir) > kAhead;
    }
    if (!ahead) continue;
    Vec3f t, b;
    tangents_from_normal(dir.cast<float>(), t, b);
    for (int side = 0; side < 2; ++side) {
      const auto [photo, px] = px_of(used[i], side);
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Observation, 2, 3, 3, 2>(
                                   new Observation{relative(px, sizes[photo]), dir, t.cast<double>(), b.cast<double>(),
                                                   bundle.probe_from_photo[photo].transpose()}),
                               &loss, lens, turns[photo].data(), offsets[i].data());
      has_turn[photo] = true;
    }
    order->AddElementToGroup(offsets[i].data(), 0);
  }
  BundleFit fit;
  fit.matches = static_cast<int>(used.size());
  fit.off_px.resize(links.size());
  if (used.empty()) {
    delete order;
    return fit;
  }
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    if (has_turn[k]) order->AddElementToGroup(turns[k].data(), 1);
  }
  order->AddElementToGroup(lens, 1);
  const auto fixed = static_cast<std::size_t>(bundle.fixed);
  if (has_turn[fixed]) problem.SetParameterBlockConstant(turns[fixed].data());
  // What is expected weighs as residuals of a common size do.
  constexpr double kResidual = 3e-4;  // of the longer side: half a pixel of 1600
  ceres::LossFunctionWrapper weight(new ceres::ScaledLoss(nullptr, kResidual * kResidual, ceres::TAKE_OWNERSHIP),
                                    ceres::TAKE_OWNERSHIP);
  const auto expect = [&](int index, double value, double deviation) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Expectation, 1, 3>(new Expectation{index, value, deviation}), &weight, lens);
  };
  if (bundle.focal_deviation > 0) expect(0, std::log(bundle.expected_focal), bundle.focal_deviation);
  if (distortion) {
    expect(1, 0, 0.1);  // what lenses that are not fisheyes have
    expect(2, 0, 0.05);
  } else {
    problem.SetManifold(lens, new ceres::SubsetManifold(3, {1, 2}));
  }

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering.reset(order);
  options.num_threads = 1;  // the same sums whatever --threads
  options.logging_type = ceres::SILENT;
  // A wide loss first, so that a guess some degrees off is drawn in by most matches, then ever less for outliers.
  constexpr double kLeastShare = 4e-4;
  for (double share = std::max(reach, kLeastShare);; share = std::max(0.4 * share, kLeastShare)) {
    const bool last = share <= kLeastShare;
    options.max_num_iterations = last ? 100 : 20;
    options.function_tolerance = last ? 1e-9 : 1e-5;
    loss.Reset(new ceres::CauchyLoss(share), ceres::TAKE_OWNERSHIP);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    fit.cost = 2 * summary.final_cost;
    if (last) break;
  }

  bundle.lens = {std::exp(lens[0]), lens[1], lens[2]};
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    Mat3 turn;
    ceres::AngleAxisToRotationMatrix(turns[k].data(), ceres::ColumnMajorAdapter3x3(turn.data()));
    bundle.probe_from_photo[k] = (turn * bundle.probe_from_photo[k].transpose()).transpose();
  }
  // What is left of all matches, also those that had no say: half the way from one to the other, in either photograph.
  std::vector<double> all_off;
  for (std::size_t l = 0; l < links.size(); ++l) {
    if (!links[l].verified) continue;
    for (std::size_t m = 0; m < links[l].matches.size(); ++m) {
      const auto [a, p] = px_of({l, m}, 0);
      const auto [b, q] = px_of({l, m}, 1);
      const Rectilinear camera_a = camera_of(bundle.lens, sizes[a]), camera_b = camera_of(bundle.lens, sizes[b]);
      double off = longer_side(sizes[a]);
      const auto ray = camera_b.dir_from_px(q);
      const auto there =
          ray ? camera_a.px_from_dir(bundle.probe_from_photo[a].transpose() * (bundle.probe_from_photo[b] * *ray))
              : std::nullopt;
      if (there) off = 0.5 * (*there - p).norm();
      fit.off_px[l].push_back(off);
      all_off.push_back(off / longer_side(sizes[a]));
    }
  }
  fit.median_off = median_of(all_off);
  return fit;
}

}  // namespace hdr::internal
