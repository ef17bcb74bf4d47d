#include "libhdr/light/sh_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/clamped_cosine.h"
#include "libhdr/light/internal/region_irradiance.h"

namespace hdr {
namespace {

// Spread evenly [Swinbank06]: some 5 degrees apart, where degree 2 bends over 90.
std::vector<Vec3> even_normals(int count) {
  std::vector<Vec3> normals;
  for (int k = 0; k < count; ++k) {
    const double y = 1 - (2 * k + 1.0) / count, turn = kPi * (3 - std::sqrt(5.0)) * k, s = std::sqrt(1 - y * y);
    normals.emplace_back(s * std::cos(turn), y, s * std::sin(turn));
  }
  return normals;
}

// [Lawson61]: the minimax fit is a least squares fit with the right weights, and weights that are multiplied by their
// errors become those. Returns the best that was met.
Eigen::VectorXd minimax(const Eigen::MatrixXd& basis, const Eigen::VectorXd& wanted, Eigen::VectorXd best) {
  constexpr int kSteps = 300;
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(wanted.size(), 1.0 / static_cast<double>(wanted.size()));
  double least = (wanted - basis * best).cwiseAbs().maxCoeff();
  for (int step = 0; step < kSteps && least > 0; ++step) {
    const Eigen::MatrixXd weighted = weights.asDiagonal() * basis;
    const Eigen::VectorXd x = (basis.transpose() * weighted).ldlt().solve(weighted.transpose() * wanted);
    const Eigen::VectorXd off = (wanted - basis * x).cwiseAbs();
    if (off.maxCoeff() < least) {
      least = off.maxCoeff();
      best = x;
    }
    // A floor, so that a normal which was met exactly can come back.
    weights = weights.cwiseProduct(off / off.maxCoeff()).cwiseMax(1e-12);
    weights /= weights.sum();
  }
  return best;
}

}  // namespace

FittedSh fit_irradiance(View<const float> latlong, int degree) {
  constexpr int kNormals = 1500;
  FittedSh result{project(latlong, LatLong{latlong.size()}, degree), 0, 0};
  const std::vector<Vec3> normals = even_normals(kNormals);
  const auto truth = region_irradiance(latlong, {}, normals);
  std::vector<std::size_t> used;  // coefficients that have irradiance
  for (int l = 0; l <= degree; ++l)
    for (int k = l * l; clamped_cosine_coefficient(l) != 0 && k < (l + 1) * (l + 1); ++k)
      used.push_back(static_cast<std::size_t>(k));
  const auto unknowns = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd basis(kNormals, unknowns);
  std::vector<double> y(result.sh.coefficients.size());
  for (Eigen::Index i = 0; i < kNormals; ++i) {
    sh_basis(normals[static_cast<std::size_t>(i)], degree, y.data());
    for (Eigen::Index k = 0; k < unknowns; ++k) {
      const std::size_t of = used[static_cast<std::size_t>(k)];
      basis(i, k) = clamped_cosine_coefficient(static_cast<int>(std::sqrt(static_cast<double>(of)))) * y[of];
    }
  }
  for (int c = 0; c < 3; ++c) {
    Eigen::VectorXd wanted(kNormals), x(unknowns);
    for (Eigen::Index i = 0; i < kNormals; ++i) wanted[i] = truth[static_cast<std::size_t>(i)][0][c];
    for (Eigen::Index k = 0; k < unknowns; ++k) x[k] = result.sh.coefficients[used[static_cast<std::size_t>(k)]][c];
    const double largest = wanted.maxCoeff();
    if (!(largest > 0)) continue;
    result.projected = std::max(result.projected, (wanted - basis * x).cwiseAbs().maxCoeff() / largest);
    x = largest * minimax(basis, wanted / largest, x / largest);
    result.error = std::max(result.error, (wanted - basis * x).cwiseAbs().maxCoeff() / largest);
    for (Eigen::Index k = 0; k < unknowns; ++k) result.sh.coefficients[used[static_cast<std::size_t>(k)]][c] = x[k];
  }
  return result;
}

}  // namespace hdr
