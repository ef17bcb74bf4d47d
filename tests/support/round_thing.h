#pragma once
// Things in pictures that are round, and no balls.
#include "libhdr/core/image.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr::test {

/// Something round of grey radiance(x, y) on the unit disc, y down, in front of what the picture shows; its edge lies
/// between pixels.
template <class Radiance>
void paint_round(Image<float>& picture, const Disc& disc, const Radiance& radiance) {
  constexpr int kSamples = 4;
  for_rows(picture.height(), 8, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        double light = 0;
        int inside = 0;
        for (int k = 0; k < kSamples * kSamples; ++k) {
          const Vec2 p((x + (k % kSamples + 0.5) / kSamples - disc.cx) / disc.r,
                       (y + (k / kSamples + 0.5) / kSamples - disc.cy) / disc.r);
          if (p.norm() > 1) continue;
          light += radiance(p);
          ++inside;
        }
        const double beside = 1 - static_cast<double>(inside) / (kSamples * kSamples);
        for (int c = 0; c < 3; ++c) {
          picture(x, y, c) =
              static_cast<float>(beside * static_cast<double>(picture(x, y, c)) + light / (kSamples * kSamples));
        }
      }
    }
  });
}

}  // namespace hdr::test
