#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/project.h"
#include "libhdr/light/internal/quadrature.h"
#include "libhdr/light/internal/row_moments.h"

namespace hdr {
namespace {

using Coefficients = std::vector<Rgb>;

// The fewest nodes whose error on a wave of `frequency` radians a unit over `width` units is below the last digit of a
// double, by the rule's own remainder: width^(2n) n!^4 / ((2n + 1) (2n)!^3) times the derivative of order 2n.
int polar_nodes(double frequency, double width) {
  double remainder = 1;
  int n = 0;
  while (remainder > 1e-18 && n < 64) {
    ++n;
    const double k = 2.0 * n;
    remainder *= std::pow(frequency * width, 2) * std::pow(n, 4) / std::pow(k * (k - 1), 3) * (k - 1) / (k + 1);
  }
  return std::max(n, 2);
}

// Integral over the polar angles of row y of Y_lm(theta, phi = 0) sin theta, m >= 0, at index l(l+1) + m.
std::vector<double> polar_integrals(int y, int height, int degree, const GaussRule& rule) {
  std::vector<double> sum(static_cast<std::size_t>(sh_count(degree))), basis(sum.size());
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double polar = kPi * (y + rule.nodes[k]) / height;
    sh_basis({std::sin(polar), 0, std::cos(polar)}, degree, basis.data());
    const double weight = rule.weights[k] * kPi / height * std::sin(polar);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * basis[i];
  }
  return sum;
}

void add_row(const double* moments, const std::vector<double>& polar, int degree, Coefficients& total) {
  const auto moment = [moments](int k) { return Rgb(moments[3 * k], moments[3 * k + 1], moments[3 * k + 2]); };
  for (int l = 0; l <= degree; ++l) {
    const int centre = l * (l + 1);
    for (int m = 0; m <= l; ++m) {
      const double q = polar[static_cast<std::size_t>(centre + m)];
      const int cosine = m == 0 ? 0 : 2 * m - 1;
      total[static_cast<std::size_t>(centre + m)] += q * moment(cosine);
      if (m > 0) total[static_cast<std::size_t>(centre - m)] += q * moment(2 * m);
    }
  }
}

// The map's own frame has its pole on +Y and azimuth from +Z to +X, the basis has its pole on +Z and azimuth from +X to
// +Y: d_map = (z, x, y) of d. The expansion is a polynomial of degree n on the sphere, so the product of a Gauss and a
// trapezoid rule that is exact to degree 2n turns it from one frame to the other without error.
Coefficients world_from_map_frame(const Coefficients& map_frame, int degree) {
  Coefficients world(map_frame.size(), Rgb::Zero());
  std::vector<double> basis(map_frame.size());
  const GaussRule rule = gauss_legendre(degree + 1);
  const int azimuths = 2 * degree + 1;
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double z = 2 * rule.nodes[k] - 1, s = std::sqrt(1 - z * z);
    for (int i = 0; i < azimuths; ++i) {
      const double azimuth = 2 * kPi * i / azimuths;
      const Vec3 d(s * std::cos(azimuth), s * std::sin(azimuth), z);
      sh_basis({d.z(), d.x(), d.y()}, degree, basis.data());
      Rgb value = Rgb::Zero();
      for (std::size_t j = 0; j < basis.size(); ++j) value += basis[j] * map_frame[j];
      value *= 4 * kPi * rule.weights[k] / azimuths;
      sh_basis(d, degree, basis.data());
      for (std::size_t j = 0; j < basis.size(); ++j) world[j] += basis[j] * value;
    }
  }
  return world;
}

}  // namespace

Sh project_latlong(View<const float> rgb, int degree) {
  const int width = rgb.width(), height = rgb.height();
  const AzimuthTable azimuth(width, degree);
  const GaussRule rule = gauss_legendre(polar_nodes(degree + 1, kPi / height));
  const Coefficients zero(static_cast<std::size_t>(sh_count(degree)), Rgb::Zero());
  constexpr int kRowsInBlock = 16;
  const Coefficients map_frame = reduce_rows(
      height, kRowsInBlock, zero,
      [&](int first, int last) {
        Coefficients part = zero;
        const auto row_size = static_cast<std::size_t>(3 * azimuth.count());
        std::vector<double> moments(row_size * static_cast<std::size_t>(last - first));
        row_moments(rgb.rows(first, last), azimuth, moments.data());
        for (int y = first; y < last; ++y) {
          const double* of_row = moments.data() + row_size * static_cast<std::size_t>(y - first);
          add_row(of_row, polar_integrals(y, height, degree, rule), degree, part);
        }
        return part;
      },
      [](Coefficients& total, const Coefficients& part) {
        for (std::size_t k = 0; k < total.size(); ++k) total[k] += part[k];
      });
  return {degree, world_from_map_frame(map_frame, degree)};
}

}  // namespace hdr
