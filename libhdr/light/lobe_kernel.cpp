#include "libhdr/light/internal/lobe_kernel.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"

namespace hdr {

std::function<double(double)> lobe_kernel(Lobe lobe, double roughness) {
  HDR_ASSERT(roughness > 0 && roughness <= 1);
  const double alpha2 = std::max(std::pow(roughness, 4), 1e-8);
  if (lobe == Lobe::kPhong) {
    const double power = 2 / alpha2 - 2;
    return [power](double t) { return t > 0 ? std::pow(t, power) : 0.0; };
  }
  // D(h) (n.l): seen head-on the half vector is half the angle away, cos^2 = (1 + n.l) / 2.
  return [alpha2](double t) {
    if (t <= 0) return 0.0;
    const double d = 0.5 * (1 + t) * (alpha2 - 1) + 1;
    return t * alpha2 / (d * d);
  };
}

}  // namespace hdr
