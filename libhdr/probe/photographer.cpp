#include "libhdr/probe/photographer.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

constexpr double kShareOfMean = 0.03;
constexpr double kFeet = -60;  ///< degrees of elevation

std::vector<double> mean_of(View<const float> latlong) {
  std::vector<double> sum(static_cast<std::size_t>(latlong.channels()));
  double weights = 0;
  for (int y = 0; y < latlong.height(); ++y) {
    const double weight = latlong_pixel_solid_angle(y, latlong.width(), latlong.height());
    for (int x = 0; x < latlong.width(); ++x) {
      for (std::size_t c = 0; c < sum.size(); ++c)
        sum[c] += weight * static_cast<double>(latlong(x, y, static_cast<int>(c)));
      weights += weight;
    }
  }
  for (double& s : sum) s /= weights;
  return sum;
}

}  // namespace

bool photographer_covers(const Vec3& probe_dir, double half_width_degrees) {
  if (probe_dir.z() <= 0) return false;
  const double w = half_width_degrees;
  const double across = std::atan2(probe_dir.x(), probe_dir.z()) / kDegree;
  const double up = std::asin(std::clamp(probe_dir.y(), -1.0, 1.0)) / kDegree;
  const double head_up = up - 1.1 * w;
  if (across * across + head_up * head_up < 0.36 * w * w) return true;
  if (up > 0.4 * w || up < kFeet) return false;
  // Shoulders and trunk, then one leg after the other, and the tripod's column between them.
  if (up > -3 * w) return std::abs(across) < w * (up > 0 ? std::sqrt(std::max(0.0, 1 - up / (0.4 * w))) : 1.0);
  return std::abs(std::abs(across) - 0.55 * w) < 0.3 * w || std::abs(across) < 0.08 * w;
}

Image<float> with_photographer(View<const float> latlong, double half_width_degrees, const Mat3& scene_from_probe) {
  constexpr int kSide = 4;
  if (!(half_width_degrees > 0 && half_width_degrees < 40))
    throw Error("--photographer: give the figure's half-width in degrees, between 0 and 40");
  const std::vector<double> mean = mean_of(latlong);
  const LatLong scene{latlong.size()};
  Image<float> result(latlong.size(), latlong.channels());
  for_rows(latlong.height(), 8, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < latlong.width(); ++x) {
        int covered = 0;
        for (int k = 0; k < kSide * kSide; ++k) {
          const Vec3 d = *scene.dir_from_px({x + (k % kSide + 0.5) / kSide, y + (k / kSide + 0.5) / kSide});
          covered += photographer_covers(scene_from_probe.transpose() * d, half_width_degrees) ? 1 : 0;
        }
        const double share = covered / static_cast<double>(kSide * kSide);
        for (int c = 0; c < latlong.channels(); ++c) {
          const double dark = kShareOfMean * mean[static_cast<std::size_t>(c)];
          result(x, y, c) = static_cast<float>((1 - share) * static_cast<double>(latlong(x, y, c)) + share * dark);
        }
      }
    }
  });
  return result;
}

}  // namespace hdr
