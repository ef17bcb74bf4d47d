// The basis against its closed forms and its law: orthonormal.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/quadrature.h"
#include "libhdr/light/sh.h"

namespace hdr {
namespace {

Vec3 random_dir(Random& random) {
  const Vec3 d(random.normal(), random.normal(), random.normal());
  return d.normalized();
}

TEST(ShBasis, NineClosedForms) {
  Random random(1, 0);
  for (int i = 0; i < 100; ++i) {
    const Vec3 d = random_dir(random);
    const double x = d.x(), y = d.y(), z = d.z();
    const double expected[9] = {0.282095,
                                0.488603 * y,
                                0.488603 * z,
                                0.488603 * x,
                                1.092548 * x * y,
                                1.092548 * y * z,
                                0.315392 * (3 * z * z - 1),
                                1.092548 * x * z,
                                0.546274 * (x * x - y * y)};
    double basis[9];
    sh_basis(d, 2, basis);
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(basis[k], expected[k], 1e-6) << "function " << k << " at " << d.transpose();
  }
}

TEST(ShBasis, OrthonormalUpToTheHighestDegree) {
  // A Gauss rule in z times equal azimuths is exact for products of two functions of degree 32.
  constexpr int kCount = (kMaxShDegree + 1) * (kMaxShDegree + 1);
  const GaussRule rule = gauss_legendre(kMaxShDegree + 1);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(kCount, kCount);
  Eigen::VectorXd basis(kCount);
  constexpr int kAzimuths = 2 * kMaxShDegree + 1;
  Eigen::MatrixXd samples(kCount, kAzimuths);
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double z = 2 * rule.nodes[k] - 1, s = std::sqrt(1 - z * z);
    for (int i = 0; i < kAzimuths; ++i) {
      const double azimuth = 2 * kPi * i / kAzimuths;
      sh_basis({s * std::cos(azimuth), s * std::sin(azimuth), z}, kMaxShDegree, basis.data());
      samples.col(i) = basis;
    }
    gram.noalias() += 4 * kPi * rule.weights[k] / kAzimuths * samples * samples.transpose();
  }
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(kCount, kCount)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ShBasis, FiniteAtThePoles) {
  double basis[(kMaxShDegree + 1) * (kMaxShDegree + 1)];
  for (const double z : {1.0, -1.0}) {
    sh_basis({0, 0, z}, kMaxShDegree, basis);
    for (int l = 0; l <= kMaxShDegree; ++l) {
      for (int m = -l; m <= l; ++m) {
        const double expected = m == 0 ? std::sqrt((2 * l + 1) / (4 * kPi)) * (l % 2 == 1 ? z : 1) : 0;
        EXPECT_NEAR(basis[l * (l + 1) + m], expected, 1e-12) << "l " << l << " m " << m << " at z = " << z;
      }
    }
  }
}

TEST(Quadrature, GaussRuleIsExactForPolynomials) {
  for (const int n : {1, 2, 3, 8, 33, 64}) {
    const GaussRule rule = gauss_legendre(n);
    for (int power = 0; power < 2 * n; ++power) {
      double sum = 0;
      for (std::size_t k = 0; k < rule.nodes.size(); ++k) sum += rule.weights[k] * std::pow(rule.nodes[k], power);
      EXPECT_NEAR(sum * (power + 1), 1, 1e-13 * (power + 1)) << "x^" << power << " with " << n << " nodes";
    }
  }
}

}  // namespace
}  // namespace hdr
