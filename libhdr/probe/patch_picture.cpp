#include "libhdr/probe/internal/patch_picture.h"

#include <algorithm>

#include "libhdr/core/parallel.h"

namespace hdr::internal {

PatchPicture::PatchPicture(View<const float> picture) : pixels_(picture.size(), 4) {
  const int right = picture.width() - 1, bottom = picture.height() - 1;
  for_rows(picture.height(), 32, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x <= right; ++x) {
        pixels_(x, y, 0) = picture(x, y);
        pixels_(x, y, 1) = 0.5f * (picture(std::min(x + 1, right), y) - picture(std::max(x - 1, 0), y));
        pixels_(x, y, 2) = 0.5f * (picture(x, std::min(y + 1, bottom)) - picture(x, std::max(y - 1, 0)));
        pixels_(x, y, 3) = 0;
      }
    }
  });
}

PatchMean PatchPicture::mean(const Vec2& px, const Eigen::Matrix2d& sides) const {
  // Three samples a side, with the deviation of a uniform one.
  constexpr double kApart = 0.35355;
  constexpr float kShare = 1.0f / 9;
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (int k = 0; k < 9; ++k) {
    const Vec2 at = px + kApart * sides * Vec2(k % 3 - 1, k / 3 - 1);
    const double x = std::clamp(at.x() - 0.5, 0.0, pixels_.width() - 1.001);
    const double y = std::clamp(at.y() - 0.5, 0.0, pixels_.height() - 1.001);
    const int left = static_cast<int>(x), top = static_cast<int>(y);
    const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
    const auto tap = [&](int i, int j) { return Eigen::Map<const Eigen::Array4f>(pixels_.pixel(left + i, top + j)); };
    sum += (1 - fy) * ((1 - fx) * tap(0, 0) + fx * tap(1, 0)) + fy * ((1 - fx) * tap(0, 1) + fx * tap(1, 1));
  }
  sum *= kShare;
  return {static_cast<double>(sum[0]), Vec2(static_cast<double>(sum[1]), static_cast<double>(sum[2]))};
}

}  // namespace hdr::internal
