#include "libhdr/render/internal/lambert_edge.h"

#include <cmath>

namespace hdr {

// f = N h / 2 with N = n . (a x b) and h = angle / |a x b|, a function of S = |a x b|^2 and d = a . b. When the surface
// moves by t, a and b become a - t and b - t: with e = a - b, a x b becomes a x b + t x e, and d becomes
// d - t . (a + b) + t^2. [Holzschuch98] has the same derivatives as integrals along the edge.
LambertEdge lambert_edge(const Vec3& a, const Vec3& b, const Vec3& n) {
  const Vec3 across = a.cross(b), e = a - b;
  const double s2 = across.squaredNorm(), d = a.dot(b), r2 = s2 + d * d;
  if (!(s2 > 1e-24 * r2)) return {};  // ends in one direction: no angle
  const double s = std::sqrt(s2), h = std::atan2(s, d) / s;
  const double h_s = (d / r2 - h) / (2 * s2), h_d = -1 / r2;
  const double h_dd = 2 * d / (r2 * r2), h_sd = 1 / (r2 * r2), h_ss = (-d / (r2 * r2) - 3 * h_s) / (2 * s2);
  const Vec3 grad_s = 2 * e.cross(across), grad_d = -(a + b), grad_n = e.cross(n);
  const Mat3 hess_s = 2 * (e.squaredNorm() * Mat3::Identity() - e * e.transpose());
  const Vec3 grad_h = h_s * grad_s + h_d * grad_d;
  const Mat3 mixed = grad_s * grad_d.transpose();
  const Mat3 hess_h = h_ss * grad_s * grad_s.transpose() + h_sd * (mixed + mixed.transpose()) +
                      h_dd * grad_d * grad_d.transpose() + h_s * hess_s + 2 * h_d * Mat3::Identity();
  const double big_n = n.dot(across);
  const Mat3 cross_terms = grad_n * grad_h.transpose();
  return {0.5 * big_n * h, 0.5 * (h * grad_n + big_n * grad_h),
          0.5 * (cross_terms + cross_terms.transpose() + big_n * hess_h)};
}

}  // namespace hdr
