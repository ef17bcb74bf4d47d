#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/clamped_cosine.h"
#include "libhdr/light/sh.h"
#include "libhdr/light/sh_latlong.h"
#include "libhdr/light/sh_reflect.h"

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

namespace {

// Down from `start`, in steps across the sphere that are halved when none of them helps.
double least_near(const Sh& sh, int channel, Vec3 place, double step) {
  double least = irradiance(sh, place)[channel];
  for (; step > 1e-7; step *= 0.5) {
    bool moved = true;
    for (int turn = 0; moved && turn < 64; ++turn) {
      moved = false;
      Vec3f t, b;
      tangents_from_normal(place.cast<float>(), t, b);
      const Vec3 ways[] = {t.cast<double>(), b.cast<double>(), -t.cast<double>(), -b.cast<double>()};
      for (const Vec3& way : ways) {
        const Vec3 next = (place + step * way).normalized();
        const double value = irradiance(sh, next)[channel];
        if (value >= least) continue;
        least = value;
        place = next;
        moved = true;
      }
    }
  }
  return least;
}

}  // namespace

Rgb least_irradiance(const Sh& sh) {
  const Size grid{48 + 8 * sh.degree, 24 + 4 * sh.degree};
  Rgb least = Rgb::Constant(std::numeric_limits<double>::infinity());
  std::array<Vec3, 3> places{Vec3::UnitY(), Vec3::UnitY(), Vec3::UnitY()};
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const Vec3 n = dir_from_latlong((x + 0.5) / grid.width, (y + 0.5) / grid.height);
      const Rgb e = irradiance(sh, n);
      for (int c = 0; c < 3; ++c) {
        if (e[c] >= least[c]) continue;
        least[c] = e[c];
        places[static_cast<std::size_t>(c)] = n;
      }
    }
  }
  for (int c = 0; c < 3; ++c) least[c] = least_near(sh, c, places[static_cast<std::size_t>(c)], kPi / grid.height);
  return least;
}

Image<float> irradiance_map(const Sh& sh, Size size) {
  std::vector<double> bands;
  for (int l = 0; l <= sh.degree; ++l) bands.push_back(clamped_cosine_coefficient(l));
  Image<float> map = latlong_of(convolved(sh, bands), size);
  for (int y = 0; y < size.height; ++y)
    for (int k = 0; k < 3 * size.width; ++k) map.row(y)[k] = std::max(0.0f, map.row(y)[k]);
  return map;
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
