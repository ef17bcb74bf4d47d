#include "libhdr/probe/vignetting.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"

namespace hdr {

void divide_vignetting(RadianceMap& map, const Vignetting& vignetting) {
  constexpr int kSteps = 256;
  constexpr double kLeast = 0.01;
  for (int k = 0; k <= kSteps; ++k) {
    const double r = 1.0 * k / kSteps, left = vignetting.at(r * r);
    if (left >= kLeast) continue;
    throw Error(
        fmt::format("vignetting: {:.3g} of the light is left {:.2f} half-diagonals from the centre; give "
                    "coefficients that keep it above {}",
                    left, r, kLeast));
  }
  const Size size = map.size();
  const double cx = 0.5 * size.width, cy = 0.5 * size.height, unit2 = cx * cx + cy * cy;
  for (Image<float>* plane : {&map.rgb, &map.stddev}) {
    if (plane->empty()) continue;
    for_rows(size.height, 16, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        for (int x = 0; x < size.width; ++x) {
          const double dx = x + 0.5 - cx, dy = y + 0.5 - cy;
          const auto scale = static_cast<float>(1 / vignetting.at((dx * dx + dy * dy) / unit2));
          for (int c = 0; c < plane->channels(); ++c) (*plane)(x, y, c) *= scale;
        }
      }
    });
  }
}

}  // namespace hdr
