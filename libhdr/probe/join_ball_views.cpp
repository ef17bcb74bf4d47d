#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/probe/ball_views.h"
#include "libhdr/probe/internal/ball_sphere.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

/// The weight of a view in a direction: the square of the cosine of incidence, as detail and area go, and next to
/// nothing where the photographer may stand.
double weight_of(const BallView& view, const Vec3& dir) {
  constexpr double kLeast = 1e-4;  // where no other view shows the place, he stays
  const double seen = internal::visibility(view, dir);
  return seen * seen * (kLeast + (1 - kLeast) * internal::nobody_there(view, dir));
}

/// Whether views that both have a say differ by more than their registration explains.
bool disagree(const std::vector<double>& weights, const std::vector<double>& light, double most_log_ratio) {
  constexpr double kHasASay = 0.05;
  const double heaviest = *std::max_element(weights.begin(), weights.end());
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] < kHasASay * heaviest) continue;
    least = std::min(least, light[k]);
    most = std::max(most, light[k]);
  }
  return most > least * std::exp(most_log_ratio);
}

}  // namespace

Image<float> join_ball_views(const std::vector<BallView>& views, const std::vector<RegisteredView>& registered,
                             const Projection& to, Size size, const Mat3& first_from_probe) {
  HDR_ASSERT(!views.empty() && views.size() == registered.size());
  std::vector<BallView> seen = views;
  std::vector<Image<float>> pictures;
  std::vector<Mat3> view_from_probe;
  for (std::size_t k = 0; k < views.size(); ++k) {
    seen[k].ball = registered[k].ball;
    view_from_probe.push_back(registered[k].probe_from_view.transpose() * first_from_probe);
    pictures.push_back(resample(views[k].rgb, seen[k].ball, to, size, view_from_probe.back()));
  }
  double most_log_ratio = 0.4;
  for (const RegisteredView& view : registered) most_log_ratio = std::max(most_log_ratio, 4 * view.overlap_rms);
  Image<float> result(size, views.front().rgb.channels());
  for_rows(size.height, 8, [&](int first, int last) {
    std::vector<double> weights(views.size()), light(views.size());
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const auto dir = dir_from_px(to, {x + 0.5, y + 0.5});
        if (!dir) continue;
        double total = 0;
        for (std::size_t k = 0; k < views.size(); ++k) {
          weights[k] = weight_of(seen[k], view_from_probe[k] * *dir);
          const float* p = pictures[k].pixel(x, y);
          light[k] = registered[k].gain * static_cast<double>(luminance(p[0], p[1], p[2]));
        }
        if (disagree(weights, light, most_log_ratio)) {
          for (double& w : weights) w *= w * w * w;
        }
        for (const double w : weights) total += w;
        if (total <= 0) continue;
        for (int c = 0; c < result.channels(); ++c) {
          double sum = 0;
          for (std::size_t k = 0; k < views.size(); ++k)
            sum += weights[k] * registered[k].gain * static_cast<double>(pictures[k](x, y, c));
          result(x, y, c) = static_cast<float>(sum / total);
        }
      }
    }
  });
  return result;
}

}  // namespace hdr
