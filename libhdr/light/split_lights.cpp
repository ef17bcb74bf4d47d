#include "libhdr/light/split_lights.h"

#include <algorithm>
#include <limits>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

// Mean luminance over the sphere of what lies below `level`.
double mean_below(View<const float> map, double level) {
  const double sum = reduce_rows(
      map.height(), 16, 0.0,
      [&](int first, int last) {
        double part = 0;
        for (int y = first; y < last; ++y) {
          double row = 0;
          for (int x = 0; x < map.width(); ++x) {
            const float* p = map.pixel(x, y);
            row += std::min(luminance<double>(p[0], p[1], p[2]), level);
          }
          part += row * latlong_pixel_solid_angle(y, map.width(), map.height());
        }
        return part;
      },
      [](double& total, double part) { total += part; });
  return sum / (4 * kPi);
}

}  // namespace

SplitLights split_lights(View<const float> latlong, double contrast) {
  HDR_ASSERT(latlong.channels() == 3 && contrast > 1);
  SplitLights split{Image<float>(latlong.size(), 3), Image<float>(latlong.size(), 3)};
  const double whole = mean_below(latlong, std::numeric_limits<double>::infinity());
  split.level = contrast * whole;
  // Falls towards the fixed point, as the mean of a map that is cut lower is lower.
  constexpr int kSteps = 32;
  for (int step = 0; step < kSteps; ++step) {
    const double lower = contrast * mean_below(latlong, split.level);
    const bool there = lower > 0.999 * split.level;
    if (lower > 0) split.level = lower;
    if (there || !(lower > 0)) break;
  }
  for_rows(latlong.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < latlong.width(); ++x) {
        const float* p = latlong.pixel(x, y);
        const double value = luminance<double>(p[0], p[1], p[2]);
        const auto kept = static_cast<float>(value > split.level ? split.level / value : 1);
        for (int c = 0; c < 3; ++c) {
          split.soft(x, y, c) = kept * p[c];
          split.compact(x, y, c) = p[c] - split.soft(x, y, c);
        }
      }
    }
  });
  split.share = whole > 0 ? 1 - mean_below(latlong, split.level) / whole : 0;
  return split;
}

}  // namespace hdr
