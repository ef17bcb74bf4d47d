#include "libhdr/light/horizontal_irradiance.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr {

Rgb horizontal_irradiance(View<const float> latlong) {
  HDR_ASSERT(latlong.channels() == 3 && !latlong.empty());
  const int width = latlong.width(), height = latlong.height();
  const auto of_rows = [&](int first, int last) {
    Rgb sum = Rgb::Zero();
    for (int y = first; y < last; ++y) {
      // The integral of cos(a) sin(a) over a = [top, bottom] is (sin(bottom)^2 - sin(top)^2) / 2, up to the horizon; as
      // a product, which does not cancel there.
      const double top = std::min(kPi * y / height, 0.5 * kPi), bottom = std::min(kPi * (y + 1) / height, 0.5 * kPi);
      Rgb row = Rgb::Zero();
      for (int x = 0; x < width; ++x) {
        const float* pixel = latlong.pixel(x, y);
        row += Rgb(pixel[0], pixel[1], pixel[2]);
      }
      sum += 2 * kPi / width * 0.5 * std::sin(bottom + top) * std::sin(bottom - top) * row;
    }
    return sum;
  };
  Rgb start = Rgb::Zero();
  return reduce_rows((height + 1) / 2, 16, start, of_rows, [](Rgb& total, const Rgb& part) { total += part; });
}

}  // namespace hdr
