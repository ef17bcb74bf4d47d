#include "libhdr/probe/reflectance.h"

#include <fmt/format.h>

#include <algorithm>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"

namespace hdr {

void require_reflectance(const Rgb& share) {
  if ((share > 0).all() && (share <= 1).all()) return;
  throw Error(fmt::format("--reflectance {},{},{}: give shares above 0 and up to 1, e.g. 0.55,0.56,0.55", share[0],
                          share[1], share[2]));
}

Rgb pixel_reflectance(const MirrorBall& ball, int x, int y, const Rgb& normal_incidence) {
  // Away from the rim the middle of the pixel is its mean; at the rim reflectance changes within a pixel.
  constexpr double kEven = 0.3;
  constexpr int kSide = 8;
  const auto middle = cos_incidence(ball, {x + 0.5, y + 0.5});
  if (middle && *middle > kEven) return schlick_reflectance(normal_incidence, *middle);
  Rgb sum = Rgb::Zero();
  int covered = 0;
  for (int k = 0; k < kSide * kSide; ++k) {
    const auto cosine = cos_incidence(ball, {x + (k % kSide + 0.5) / kSide, y + (k / kSide + 0.5) / kSide});
    if (!cosine) continue;
    sum += schlick_reflectance(normal_incidence, *cosine);
    ++covered;
  }
  return covered > 0 ? Rgb(sum / covered) : Rgb::Ones();
}

void divide_by_reflectance(RadianceMap& picture, const MirrorBall& ball, const Rgb& normal_incidence) {
  require_valid(ball);
  require_reflectance(normal_incidence);
  const int channels = std::min(3, picture.rgb.channels());
  for_rows(picture.rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < picture.rgb.width(); ++x) {
        const Rgb share = pixel_reflectance(ball, x, y, normal_incidence);
        for (int c = 0; c < channels; ++c) {
          picture.rgb(x, y, c) = static_cast<float>(picture.rgb(x, y, c) / share[c]);
          if (!picture.stddev.empty()) picture.stddev(x, y, c) = static_cast<float>(picture.stddev(x, y, c) / share[c]);
        }
      }
    }
  });
}

}  // namespace hdr
