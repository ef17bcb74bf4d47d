#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/prefilter.h"

namespace hdr {
namespace {

// Smith's Lambda of GGX at the cosine of an angle, [Heitz18] eq. 2.
double lambda(double alpha, double cosine) {
  const double tan2 = (1 - cosine * cosine) / (cosine * cosine);
  return 0.5 * (std::sqrt(1 + alpha * alpha * tan2) - 1);
}

struct ScaleAndBias {
  double a = 0, b = 0;
};

// Half vectors by D(h) (n.h): the integrand f (n.l) / pdf is F G2 (v.h) / ((n.h) (n.v)); F = F0 (1 - w) + w with
// w = (1 - v.h)^5. Points of a midpoint rule in the first number, Fibonacci's lattice in the second.
ScaleAndBias integrate(double cos_v, double roughness, int samples) {
  const double alpha = std::max(roughness * roughness, 1e-4), alpha2 = alpha * alpha;
  const double sin_v = std::sqrt(1 - cos_v * cos_v), lambda_v = lambda(alpha, cos_v);
  constexpr double kGolden = 0.6180339887498949;
  ScaleAndBias sum;
  for (int k = 0; k < samples; ++k) {
    const double u = (k + 0.5) / samples, phi = 2 * kPi * std::fmod(k * kGolden, 1.0);
    const double cos_h = std::sqrt((1 - u) / (1 + (alpha2 - 1) * u)),
                 sin_h = std::sqrt(std::max(0.0, 1 - cos_h * cos_h));
    const double v_dot_h = sin_v * sin_h * std::cos(phi) + cos_v * cos_h;
    const double cos_l = 2 * v_dot_h * cos_h - cos_v;
    if (cos_l <= 0 || v_dot_h <= 0) continue;
    const double g2 = 1 / (1 + lambda_v + lambda(alpha, cos_l));
    const double value = g2 * v_dot_h / (cos_h * cos_v);
    const double w = std::pow(1 - v_dot_h, 5);
    sum.a += value * (1 - w);
    sum.b += value * w;
  }
  return {sum.a / samples, sum.b / samples};
}

}  // namespace

Image<float> split_sum_table(int size, int samples) {
  HDR_ASSERT(size > 0 && samples > 0);
  Image<float> table(size, size, 3);
  for_rows(size, 2, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size; ++x) {
        const ScaleAndBias result = integrate((x + 0.5) / size, (y + 0.5) / size, samples);
        table(x, y, 0) = static_cast<float>(result.a);
        table(x, y, 1) = static_cast<float>(result.b);
      }
    }
  });
  return table;
}

}  // namespace hdr
