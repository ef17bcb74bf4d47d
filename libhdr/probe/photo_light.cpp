#include "libhdr/probe/internal/photo_light.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/median.h"
#include "libhdr/core/parallel.h"
#include "libhdr/probe/internal/ball_sphere.h"

namespace hdr::internal {
namespace {

constexpr int kDirections = 20000;

struct Sample {
  std::size_t photo = 0;
  double log_light = 0, r2 = 0;  ///< r in half-diagonals of the frame
};

/// The mean around a place, so that a fraction of a pixel more or less does not matter; nullopt where it clips, is
/// black or leaves the frame.
std::optional<Sample> look(const std::vector<StitchPhoto>& photos, const Stitch& stitch, std::size_t k,
                           const Vec3& dir) {
  const StitchedPhoto& view = stitch.photos[k];
  const auto px = view.lens.px_from_dir(view.probe_from_view.transpose() * dir);
  if (!px) return std::nullopt;
  const View<const float> rgb = photos[k].rgb, alpha = photos[k].alpha;
  const int half = 1 + std::max(rgb.width(), rgb.height()) / 500;
  const int x = static_cast<int>(px->x()), y = static_cast<int>(px->y());
  if (x < half || y < half || x + half >= rgb.width() || y + half >= rgb.height()) return std::nullopt;
  double sum = 0;
  for (int j = y - half; j <= y + half; ++j) {
    for (int i = x - half; i <= x + half; ++i) {
      const float* p = rgb.pixel(i, j);
      if (static_cast<double>(std::max({p[0], p[1], p[2]})) >= photos[k].ceiling) return std::nullopt;
      if (!alpha.empty() && alpha(i, j) < 1) return std::nullopt;
      sum += luminance<double>(p[0], p[1], p[2]);
    }
  }
  if (!(sum > 0)) return std::nullopt;
  const double count = (2 * half + 1) * (2 * half + 1);
  const Vec2 middle(0.5 * rgb.width(), 0.5 * rgb.height());
  return Sample{k, std::log(sum / count), (*px - middle).squaredNorm() / middle.squaredNorm()};
}

/// Both photographs' light, after gain and vignetting, is the same.
struct SameLight {
  Sample a, b;
  template <class T>
  bool operator()(const T* gain_a, const T* gain_b, const T* k, T* residual) const {
    const auto passed = [&](double r2) { return 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])); };
    const T in_a = passed(a.r2), in_b = passed(b.r2);
    if (!(in_a > 0.05) || !(in_b > 0.05)) return false;
    residual[0] = gain_a[0] - ceres::log(in_a) - gain_b[0] + ceres::log(in_b) + (a.log_light - b.log_light);
    return true;
  }
};

struct Small {
  double deviation;
  template <class T>
  bool operator()(const T* k, T* residual) const {
    for (int i = 0; i < 3; ++i) residual[i] = k[i] / deviation;
    return true;
  }
};

}  // namespace

void fit_light(const std::vector<StitchPhoto>& photos, bool vignetting, Stitch& stitch) {
  const std::vector<Vec3> directions = even_directions(kDirections);
  std::vector<std::vector<Sample>> seen(directions.size());
  for_rows(kDirections, 500, [&](int first, int last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      for (std::size_t k = 0; k < photos.size(); ++k) {
        if (!stitch.photos[k].used) continue;
        if (const auto sample = look(photos, stitch, k, directions[i])) seen[i].push_back(*sample);
      }
    }
  });

  std::vector<double> gains(photos.size(), 0);  // ln
  double k[3] = {stitch.vignetting.k1, stitch.vignetting.k2, stitch.vignetting.k3};
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::LossFunctionWrapper loss(new ceres::CauchyLoss(1), ceres::TAKE_OWNERSHIP);
  ceres::Problem problem(ownership);
  std::vector<SameLight> pairs;
  for (const auto& samples : seen) {
    for (std::size_t i = 0; i + 1 < samples.size(); ++i) pairs.push_back({samples[i], samples[i + 1]});
  }
  if (pairs.empty()) return;
  for (const SameLight& pair : pairs) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SameLight, 1, 1, 1, 3>(new SameLight(pair)), &loss,
                             &gains[pair.a.photo], &gains[pair.b.photo], k);
  }
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Small, 3, 3>(new Small{1}), nullptr, k);
  const auto first = static_cast<std::size_t>(
      std::find_if(stitch.photos.begin(), stitch.photos.end(), [](const StitchedPhoto& p) { return p.used; }) -
      stitch.photos.begin());
  if (problem.HasParameterBlock(&gains[first])) problem.SetParameterBlockConstant(&gains[first]);
  if (!vignetting) problem.SetParameterBlockConstant(k);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 30;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  for (const double width : {1.0, 0.2, 0.05, 0.02}) {  // of ln, what is near or moved differs by more
    loss.Reset(new ceres::CauchyLoss(width), ceres::TAKE_OWNERSHIP);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
  }
  for (std::size_t i = 0; i < photos.size(); ++i) stitch.photos[i].gain = std::exp(gains[i]);
  stitch.vignetting = {k[0], k[1], k[2]};
  std::vector<double> off;
  for (const SameLight& pair : pairs) {
    double residual = 0;
    if (pair(&gains[pair.a.photo], &gains[pair.b.photo], k, &residual)) off.push_back(std::abs(residual));
  }
  constexpr double kSigmaOfMedian = 1.4826;
  stitch.overlap_rms = kSigmaOfMedian * median_of(off);
}

}  // namespace hdr::internal
