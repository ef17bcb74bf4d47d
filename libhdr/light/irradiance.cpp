#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/clamped_cosine.h"
#include "libhdr/light/sh.h"

namespace hdr {

// [Ramamoorthi01] eq. 8: A_0 = pi, A_1 = 2 pi / 3, odd ones vanish, and for even l
//   A_l = 2 pi (-1)^(l/2 - 1) / ((l + 2)(l - 1)) l! / (2^l (l/2)!^2),  so that A_l+2 / A_l = -(l - 1) / (l + 4).
double clamped_cosine_coefficient(int l) {
  if (l == 0) return kPi;
  if (l == 1) return 2 * kPi / 3;
  if (l % 2 == 1) return 0;
  double a = kPi / 4;
  for (int k = 2; k < l; k += 2) a *= -(k - 1.0) / (k + 4.0);
  return a;
}

Rgb irradiance(const Sh& sh, const Vec3& n) {
  double y[(kMaxShDegree + 1) * (kMaxShDegree + 1)];
  sh_basis(n, sh.degree, y);
  Rgb sum = Rgb::Zero();
  for (int l = 0; l <= sh.degree; ++l) {
    const double a = clamped_cosine_coefficient(l);
    if (a == 0) continue;
    for (int m = -l; m <= l; ++m) sum += a * y[l * (l + 1) + m] * sh(l, m);
  }
  return sum;
}

std::array<Mat4, 3> irradiance_matrices(const Sh& sh) {
  // [Ramamoorthi01] eq. 12: c1 = .429043, c2 = .511664, c3 = .743125, c4 = .886227, c5 = .247708.
  const double c1 = kPi / 4 * std::sqrt(15 / kPi) / 4;
  const double c2 = kPi / 3 * std::sqrt(3 / kPi) / 2;
  const double c3 = kPi / 4 * std::sqrt(5 / kPi) / 4 * 3;
  const double c4 = kPi * std::sqrt(1 / kPi) / 2;
  const double c5 = c3 / 3;
  std::array<Mat4, 3> matrices;
  for (int channel = 0; channel < 3; ++channel) {
    const auto L = [&](int l, int m) { return l <= sh.degree ? sh(l, m)[channel] : 0.0; };
    Mat4& M = matrices[static_cast<std::size_t>(channel)];
    M << c1 * L(2, 2), c1 * L(2, -2), c1 * L(2, 1), c2 * L(1, 1),    //
        c1 * L(2, -2), -c1 * L(2, 2), c1 * L(2, -1), c2 * L(1, -1),  //
        c1 * L(2, 1), c1 * L(2, -1), c3 * L(2, 0), c2 * L(1, 0),     //
        c2 * L(1, 1), c2 * L(1, -1), c2 * L(1, 0), c4 * L(0, 0) - c5 * L(2, 0);
  }
  return matrices;
}

}  // namespace hdr
