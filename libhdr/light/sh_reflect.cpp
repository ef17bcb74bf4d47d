#include "libhdr/light/sh_reflect.h"

#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/quadrature.h"

namespace hdr {
namespace {

// Integrals over -1..1 of kernel(t) P_l(t), both halves by a rule of their own.
std::vector<double> bands_of(const std::function<double(double)>& kernel, int degree) {
  static const GaussRule rule = gauss_legendre(512);  // sharp kernels live near t = 1, where its nodes are dense
  std::vector<double> bands(static_cast<std::size_t>(degree + 1), 0.0);
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    for (const double sign : {-1.0, 1.0}) {
      const double t = sign * rule.nodes[k], value = rule.weights[k] * kernel(t);
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

}  // namespace

Sh convolved(const Sh& light, const std::function<double(double cosine)>& kernel) {
  const std::vector<double> bands = bands_of(kernel, light.degree);
  Sh result = light;
  for (int l = 0; l <= light.degree; ++l)
    for (int m = -l; m <= l; ++m)
      result.coefficients[static_cast<std::size_t>(l * (l + 1) + m)] *= 2 * kPi * bands[static_cast<std::size_t>(l)];
  return result;
}

Sh phong_reflected(const Sh& light, double exponent) {
  HDR_ASSERT(exponent >= 0);
  const double norm = (exponent + 1) / (2 * kPi);
  return convolved(light, [&](double t) { return t > 0 ? norm * std::pow(t, exponent) : 0.0; });
}

}  // namespace hdr
