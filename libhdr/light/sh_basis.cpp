#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/sh_recurrence.h"
#include "libhdr/light/sh.h"

namespace hdr {
ShRecurrence::ShRecurrence() {
  for (int m = 0; m <= kMaxShDegree; ++m) {
    diagonal[m] = std::sqrt((2 * m + 3.0) / (2 * m + 2.0));
    for (int l = m; l <= kMaxShDegree; ++l) {
      const double next = l + 1;
      a[m][l] = std::sqrt((4 * next * next - 1) / (next * next - m * m));
      b[m][l] = l > m ? std::sqrt((1.0 * l * l - m * m) / (4.0 * l * l - 1)) : 0;
    }
  }
}

const ShRecurrence& ShRecurrence::get() {
  static const ShRecurrence recurrence;
  return recurrence;
}

// Y_lm = K_lm P_lm(cos theta) {sqrt2 cos(m phi), 1, sqrt2 sin(|m| phi)}. The factor sin^m(theta) of P_lm is moved to
// the azimuth, where it makes the polynomials Re and Im (x + iy)^m: no trigonometry, and nothing to divide by at the
// poles. What remains of K P is carried by the recurrence for fully normalised functions, whose terms stay of order one
// at any degree [Sloan13].
void sh_basis(const Vec3& dir, int degree, double* y) {
  HDR_ASSERT(degree >= 0 && degree <= kMaxShDegree);
  const ShRecurrence& recurrence = ShRecurrence::get();
  const double z = dir.z();
  double re = 1, im = 0;                    // (x + iy)^m
  double diagonal = std::sqrt(0.25 / kPi);  // K P_mm without its sin^m
  for (int m = 0; m <= degree; ++m) {
    double before = 0, value = diagonal;
    for (int l = m; l <= degree; ++l) {
      const int centre = l * (l + 1);
      if (m == 0) {
        y[centre] = value;
      } else {
        y[centre + m] = std::numbers::sqrt2 * value * re;
        y[centre - m] = std::numbers::sqrt2 * value * im;
      }
      const double after = recurrence.a[m][l] * (z * value - recurrence.b[m][l] * before);
      before = value;
      value = after;
    }
    diagonal *= recurrence.diagonal[m];
    const double re_next = re * dir.x() - im * dir.y();
    im = re * dir.y() + im * dir.x();
    re = re_next;
  }
}

Rgb evaluate(const Sh& sh, const Vec3& dir) {
  double y[(kMaxShDegree + 1) * (kMaxShDegree + 1)];
  sh_basis(dir, sh.degree, y);
  Rgb sum = Rgb::Zero();
  for (std::size_t k = 0; k < sh.coefficients.size(); ++k) sum += y[k] * sh.coefficients[k];
  return sum;
}

}  // namespace hdr
