#include "libhdr/light/sh_reflect.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/quadrature.h"

namespace hdr {

// Both halves by a rule of their own.
std::vector<double> kernel_bands(const std::function<double(double)>& kernel, int degree) {
  static const GaussRule rule = gauss_legendre(512);  // sharp kernels live near t = 1, where its nodes are dense
  HDR_ASSERT(degree >= 0);
  std::vector<double> bands(static_cast<std::size_t>(degree + 1), 0.0);
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    for (const double sign : {-1.0, 1.0}) {
      const double t = sign * rule.nodes[k], value = 2 * kPi * rule.weights[k] * kernel(t);
      if (value == 0) continue;
      double before = 0, p = 1;
      for (int l = 0; l <= degree; ++l) {
        bands[static_cast<std::size_t>(l)] += value * p;
        const double next = ((2 * l + 1) * t * p - l * before) / (l + 1);
        before = p;
        p = next;
      }
    }
  }
  return bands;
}

Sh convolved(const Sh& light, const std::vector<double>& bands) {
  HDR_ASSERT(!bands.empty());
  Sh result;
  result.degree = std::min(light.degree, static_cast<int>(bands.size()) - 1);
  for (int l = 0; l <= result.degree; ++l)
    for (int m = -l; m <= l; ++m) result.coefficients.push_back(bands[static_cast<std::size_t>(l)] * light(l, m));
  return result;
}

Sh convolved(const Sh& light, const std::function<double(double cosine)>& kernel) {
  return convolved(light, kernel_bands(kernel, light.degree));
}

Sh phong_reflected(const Sh& light, double exponent) {
  HDR_ASSERT(exponent >= 0);
  const double norm = (exponent + 1) / (2 * kPi);
  return convolved(light, [&](double t) { return t > 0 ? norm * std::pow(t, exponent) : 0.0; });
}

}  // namespace hdr
