#include "libhdr/probe/ball_doubt.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr {

double most_degrees_between(const MirrorBall& a, const MirrorBall& b) {
  constexpr int kAzimuths = 24, kRadii = 14;
  constexpr double kRim = 0.98;
  double most = 0;
  for (int k = 0; k < kAzimuths * kRadii; ++k) {
    const double azimuth = 2 * kPi * (k % kAzimuths) / kAzimuths, r = kRim * (1 + k / kAzimuths) / kRadii;
    const Vec2 px(a.disc.cx + r * a.disc.r * std::cos(azimuth), a.disc.cy + r * a.disc.r * std::sin(azimuth));
    const auto from_a = a.dir_from_px(px), from_b = b.dir_from_px(px);
    if (from_a && from_b) most = std::max(most, (*from_a - *from_b).norm());
  }
  return 2 / kDegree * std::asin(0.5 * most);
}

}  // namespace hdr
