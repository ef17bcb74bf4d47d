#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/project.h"
#include "libhdr/light/internal/quadrature.h"

namespace hdr {
namespace {

using Coefficients = std::vector<Rgb>;

// Column x of the map holds azimuths 2 pi (1/2 - u), u from x/W to (x+1)/W. One row a column:
//   integral over it of 1, cos phi, sin phi, cos 2phi, sin 2phi, ...
Eigen::MatrixXd azimuth_integrals(int width, int degree) {
  Eigen::MatrixXd table(width, 2 * degree + 1);
  const double cell = 2 * kPi / width;
  for (int x = 0; x < width; ++x) {
    const double middle = 2 * kPi * (0.5 - (x + 0.5) / width);
    table(x, 0) = cell;
    for (int m = 1; m <= degree; ++m) {
      const double chord = 2 * std::sin(0.5 * m * cell) / m;
      table(x, 2 * m - 1) = chord * std::cos(m * middle);
      table(x, 2 * m) = chord * std::sin(m * middle);
    }
  }
  return table;
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

void add_row(const Eigen::MatrixXd& moments, const std::vector<double>& polar, int degree, Coefficients& total) {
  for (int l = 0; l <= degree; ++l) {
    const int centre = l * (l + 1);
    for (int m = 0; m <= l; ++m) {
      const double q = polar[static_cast<std::size_t>(centre + m)];
      const int cosine = m == 0 ? 0 : 2 * m - 1;
      total[static_cast<std::size_t>(centre + m)] += q * moments.col(cosine).array();
      if (m > 0) total[static_cast<std::size_t>(centre - m)] += q * moments.col(2 * m).array();
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
  const Eigen::MatrixXd azimuth = azimuth_integrals(width, degree);
  const GaussRule rule = gauss_legendre(gauss_nodes_for_wave(degree + 1, kPi / height));
  const Coefficients zero(static_cast<std::size_t>(sh_count(degree)), Rgb::Zero());
  constexpr int kRowsInBlock = 16;
  const Coefficients map_frame = reduce_rows(
      height, kRowsInBlock, zero,
      [&](int first, int last) {
        Coefficients part = zero;
        for (int y = first; y < last; ++y) {
          const Eigen::Map<const Eigen::Matrix3Xf> row(rgb.row(y), 3, width);
          const Eigen::MatrixXd moments = row.cast<double>() * azimuth;
          add_row(moments, polar_integrals(y, height, degree, rule), degree, part);
        }
        return part;
      },
      [](Coefficients& total, const Coefficients& part) {
        for (std::size_t k = 0; k < total.size(); ++k) total[k] += part[k];
      });
  return {degree, world_from_map_frame(map_frame, degree)};
}

}  // namespace hdr
