#include "libhdr/probe/internal/photo_agreement.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "libhdr/core/median.h"
#include "libhdr/probe/internal/luminance.h"

namespace hdr::internal {
namespace {

constexpr int kLongest = 400;  ///< pixels
// A first rotation is off by up to one per cent of the picture: finer detail would not meet.
constexpr double kFine = 1.5, kCoarse = 6;

Image<float> reduced(Image<float> light, double& scale) {
  while (std::max(light.width(), light.height()) > kLongest && std::min(light.width(), light.height()) >= 2) {
    light = halved(light);
    scale *= 2;
  }
  return light;
}

}  // namespace

PhotoDetail::PhotoDetail(View<const float> rgb) : detail_(reduced(luminance_of(rgb), scale_)) {
  constexpr float kShareOfMedian = 0.02f;
  std::vector<float> values;
  for (int y = 0; y < detail_.height(); y += 2)
    values.insert(values.end(), detail_.row(y), detail_.row(y) + detail_.width());
  const float floor = std::max(1e-30f, kShareOfMedian * median_of(values));
  cv::Mat_<float> light(detail_.height(), detail_.width()), fine, coarse;
  for (int y = 0; y < detail_.height(); ++y) {
    for (int x = 0; x < detail_.width(); ++x) light(y, x) = std::log(detail_(x, y) + floor);
  }
  cv::GaussianBlur(light, fine, {}, kFine);
  cv::GaussianBlur(light, coarse, {}, kCoarse);
  for (int y = 0; y < detail_.height(); ++y) {
    for (int x = 0; x < detail_.width(); ++x) detail_(x, y) = fine(y, x) - coarse(y, x);
  }
}

Agreement PhotoDetail::agreement(const Rectilinear& here, const PhotoDetail& other, const Rectilinear& there,
                                 const Mat3& here_from_there) const {
  double count = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  const double right = other.detail_.width() - 0.5, bottom = other.detail_.height() - 0.5;
  for (int y = 0; y < detail_.height(); ++y) {
    for (int x = 0; x < detail_.width(); ++x) {
      const auto dir = here.dir_from_px(scale_ * Vec2(x + 0.5, y + 0.5));
      const auto px = dir ? there.px_from_dir(here_from_there.transpose() * *dir) : std::nullopt;
      if (!px) continue;
      const Vec2 at = *px / other.scale_;
      if (!(at.x() > 0.5 && at.y() > 0.5 && at.x() < right && at.y() < bottom)) continue;
      const double a = static_cast<double>(detail_(x, y)), b = bilinear(other.detail_, at);
      ++count;
      sa += a;
      sb += b;
      saa += a * a;
      sbb += b * b;
      sab += a * b;
    }
  }
  if (count == 0) return {};
  const double variance_a = (saa - sa * sa / count) / count, variance_b = (sbb - sb * sb / count) / count;
  Agreement result;
  result.share = count / (static_cast<double>(detail_.width()) * detail_.height());
  result.contrast = std::sqrt(std::max(0.0, std::min(variance_a, variance_b)));
  if (result.contrast > 0) result.correlation = (sab - sa * sb / count) / count / std::sqrt(variance_a * variance_b);
  return result;
}

}  // namespace hdr::internal
