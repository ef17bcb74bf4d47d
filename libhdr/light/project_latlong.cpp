#include <algorithm>
#include <cmath>
#include <numbers>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/project.h"
#include "libhdr/light/internal/quadrature.h"
#include "libhdr/light/internal/row_moments.h"
#include "libhdr/light/internal/sh_recurrence.h"

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

constexpr int kPairs = 16;  // rows of the upper half that are dealt with together, and their mirror images below

// Integrals over the polar angles of some rows of Y_lm(theta, phi = 0) sin theta, m >= 0. One number lies beside
// another row's, which makes vectors of the rows.
class PolarIntegrals {
 public:
  PolarIntegrals(int first, int rows, int height, int degree, const GaussRule& rule)
      : degree_(degree), sums_(static_cast<std::size_t>((degree + 1) * (degree + 1)), Lanes::Zero()) {
    const double step = kPi / height;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      Lanes z = Lanes::Zero(), sine = Lanes::Zero();
      for (int j = 0; j < rows; ++j) {
        z[j] = std::cos(step * (first + j + rule.nodes[k]));
        sine[j] = std::sin(step * (first + j + rule.nodes[k]));
      }
      add(z, sine, rule.weights[k] * step * sine);
    }
  }

  double operator()(int l, int m, int row) const { return sums_[index(l, m)][row]; }

 private:
  using Lanes = Eigen::Array<double, kPairs, 1>;

  std::size_t index(int l, int m) const { return static_cast<std::size_t>(m * (degree_ + 1) + l); }

  // As sh_basis() does at phi = 0.
  void add(const Lanes& z, const Lanes& sine, const Lanes& weight) {
    const ShRecurrence& recurrence = ShRecurrence::get();
    Lanes factor = weight * std::sqrt(0.25 / kPi);  // with sin^m and the norm of P_mm
    for (int m = 0; m <= degree_; ++m) {
      Lanes before = Lanes::Zero(), value = m == 0 ? factor : Lanes(std::numbers::sqrt2 * factor);
      for (int l = m; l <= degree_; ++l) {
        sums_[index(l, m)] += value;
        const Lanes after = recurrence.a[m][l] * (z * value - recurrence.b[m][l] * before);
        before = value;
        value = after;
      }
      factor *= recurrence.diagonal[m] * sine;
    }
  }

  int degree_;
  std::vector<Lanes> sums_;
};

// Moments of a row of the upper half and of its mirror image (nullptr where the row is its own): P_lm(-z) is P_lm(z)
// with the sign of (-1)^(l + m), so that the two share their polar integrals.
void add_pair(const double* upper, const double* lower, const PolarIntegrals& polar, int row, int degree,
              Coefficients& total) {
  Rgb moments[2][2 * kMaxShDegree + 1];  // sum and difference
  for (int k = 0; k < 2 * degree + 1; ++k) {
    const Rgb above(upper[3 * k], upper[3 * k + 1], upper[3 * k + 2]);
    const Rgb below = lower ? Rgb(lower[3 * k], lower[3 * k + 1], lower[3 * k + 2]) : Rgb::Zero();
    moments[0][k] = above + below;
    moments[1][k] = above - below;
  }
  for (int l = 0; l <= degree; ++l) {
    const int centre = l * (l + 1);
    for (int m = 0; m <= l; ++m) {
      const double q = polar(l, m, row);
      const Rgb* moment = moments[(l + m) % 2];
      total[static_cast<std::size_t>(centre + m)] += q * moment[m == 0 ? 0 : 2 * m - 1];
      if (m > 0) total[static_cast<std::size_t>(centre - m)] += q * moment[2 * m];
    }
  }
}

}  // namespace

Sh project_latlong(View<const float> rgb, int degree) {
  const int width = rgb.width(), height = rgb.height();
  const AzimuthTable azimuth(width, degree);
  const GaussRule rule = gauss_legendre(polar_nodes(degree + 1, kPi / height));
  const Coefficients zero(static_cast<std::size_t>(sh_count(degree)), Rgb::Zero());
  const Coefficients map_frame =
      reduce_rows((height + 1) / 2, kPairs, zero,
                  [&](int first, int last) {
                    Coefficients part = zero;
                    const auto row_size = static_cast<std::ptrdiff_t>(3 * azimuth.count());
                    const std::ptrdiff_t rows = last - first;
                    std::vector<double> moments(static_cast<std::size_t>(2 * rows * row_size));
                    row_moments(rgb.rows(first, last), azimuth, moments.data());
                    row_moments(rgb.rows(height - last, height - first), azimuth, moments.data() + rows * row_size);
                    const PolarIntegrals polar(first, last - first, height, degree, rule);
                    for (int y = first; y < last; ++y) {
                      const double* upper = moments.data() + row_size * (y - first);
                      const double* lower = moments.data() + row_size * (rows + last - 1 - y);
                      add_pair(upper, 2 * y + 1 == height ? nullptr : lower, polar, y - first, degree, part);
                    }
                    return part;
                  },
                  [](Coefficients& total, const Coefficients& part) {
                    for (std::size_t k = 0; k < total.size(); ++k) total[k] += part[k];
                  });
  return world_from_map_frame({degree, map_frame});
}

}  // namespace hdr
