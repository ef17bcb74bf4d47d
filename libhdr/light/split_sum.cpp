// The split sum's second half by quadrature over half vectors h. The integrand f (n.l) / pdf over D(h) (n.h) is
// F G2 (v.h) / ((n.h) (n.v)) with F = F0 (1 - w) + w, w = (1 - v.h)^5; it ends where l sinks below the surface,
//   cos(phi) = -cot(theta_v) cot(2 theta_h).
// A rule that ran across that edge would err by its step; these end on it. With tan(theta_h) = alpha tan(psi) the
// density of half vectors is 2 sin(psi) cos(psi), whatever alpha; up to 2 theta_h = pi/2 - theta_v the whole circle of
// phi counts, beyond it an arc that shrinks like a root: psi = a + (b - a) sin^2(pi t / 2) makes roots smooth.
#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/quadrature.h"
#include "libhdr/light/prefilter.h"

namespace hdr {
namespace {

constexpr int kPolar = 24, kAround = 8;  // nodes: within 2e-5 of the converged integral over the whole table
using Around = Eigen::Array<double, kAround, 1>;

struct Rules {
  GaussRule polar = gauss_legendre(kPolar), around = gauss_legendre(kAround);
  Around nodes, weights, whole;  // whole: cosines of nodes over half a circle
  Rules() {
    for (int k = 0; k < kAround; ++k) {
      nodes[k] = around.nodes[static_cast<std::size_t>(k)];
      weights[k] = around.weights[static_cast<std::size_t>(k)];
    }
    whole = (kPi * nodes).cos();
  }
};

// Smith's Lambda of GGX for cosines of angles, [Heitz18] eq. 2.
template <class T>
T lambda(double alpha, const T& cosine) {
  using std::sqrt;
  return 0.5 * (sqrt(1 + alpha * alpha * (1 - cosine * cosine) / (cosine * cosine)) - 1);
}

struct Seen {
  double alpha, cosine, sine, shadow;  // of n and v; Lambda(v)
};

// All half vectors at one angle from n, psi, up to `arc` either side of the plane of n and v.
SplitSum around(const Seen& v, double cos_psi, double sin_psi, bool whole_circle, const Rules& rules) {
  const double norm = std::hypot(cos_psi, v.alpha * sin_psi), cos_h = cos_psi / norm, sin_h = v.alpha * sin_psi / norm;
  double arc = kPi;
  if (!whole_circle) {
    const double edge = v.cosine * (sin_h * sin_h - cos_h * cos_h) / (2 * cos_h * sin_h * v.sine);
    arc = std::acos(std::clamp(edge, -1.0, 1.0));
  }
  const Around cos_phi = whole_circle ? rules.whole : Around((arc * rules.nodes).cos());
  const Around v_dot_h = (v.sine * sin_h * cos_phi + v.cosine * cos_h).max(0.0);
  const Around cos_l = (2 * cos_h * v_dot_h - v.cosine).max(1e-300);  // above 0 but for rounding
  const Around g2 = 1 / (1 + v.shadow + lambda(v.alpha, cos_l));
  const Around value = arc / kPi * rules.weights * g2 * v_dot_h / (cos_h * v.cosine);
  const Around grazing = 1 - v_dot_h, w = grazing * grazing.square().square();
  return {(value * (1 - w)).sum(), (value * w).sum()};
}

}  // namespace

SplitSum split_sum(double cos_v, double roughness) {
  HDR_ASSERT(cos_v > 0 && cos_v <= 1 && roughness >= 0 && roughness <= 1);
  const double fresnel = std::pow(1 - cos_v, 5), alpha = roughness * roughness;
  if (alpha < 1e-8) return {1 - fresnel, fresnel};  // a mirror
  static const Rules rules;
  const Seen v{alpha, cos_v, std::sqrt(1 - cos_v * cos_v), lambda(alpha, cos_v)};
  const double angle_v = std::acos(cos_v);
  const auto psi_of = [&](double angle_h) { return std::atan(std::tan(angle_h) / alpha); };
  const double ends[] = {0, psi_of(0.25 * kPi - 0.5 * angle_v), psi_of(0.25 * kPi + 0.5 * angle_v)};
  SplitSum sum;
  for (int part = 0; part < 2; ++part) {
    const double length = ends[part + 1] - ends[part];
    if (!(length > 0)) continue;
    for (std::size_t k = 0; k < kPolar; ++k) {
      const double t = 0.5 * kPi * rules.polar.nodes[k], s = std::sin(t), c = std::cos(t);
      const double psi = ends[part] + length * s * s, sin_psi = std::sin(psi), cos_psi = std::cos(psi);
      const double weight = rules.polar.weights[k] * kPi * s * c * length * 2 * sin_psi * cos_psi;
      const SplitSum ring = around(v, cos_psi, sin_psi, part == 0, rules);
      sum.scale += weight * ring.scale;
      sum.bias += weight * ring.bias;
    }
  }
  return sum;
}

Image<float> split_sum_table(int size) {
  HDR_ASSERT(size > 0);
  Image<float> table(size, size, 3);
  for_rows(size, 2, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size; ++x) {
        const SplitSum result = split_sum((x + 0.5) / size, (y + 0.5) / size);
        table(x, y, 0) = static_cast<float>(result.scale);
        table(x, y, 1) = static_cast<float>(result.bias);
      }
    }
  });
  return table;
}

}  // namespace hdr
