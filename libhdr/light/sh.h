#pragma once
// Spherical harmonics of a probe: real, orthonormal, no Condon-Shortley phase; order L00, L1-1 (y), L10 (z), L11 (x),
// L2-2 (xy), L2-1 (yz), L20 (3z^2-1), L21 (xz), L22 (x^2-y^2); L_lm = integral of L Y_lm over the sphere.
#include <array>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr {

struct Sh {
  int degree = 0;
  std::vector<Rgb> coefficients;  ///< (degree + 1)^2, index l(l+1) + m

  const Rgb& operator()(int l, int m) const { return coefficients[static_cast<std::size_t>(l * (l + 1) + m)]; }
};

inline constexpr int kMaxShDegree = 32;

/// Y_lm(dir) for all (degree + 1)^2 functions, dir of unit length.
void sh_basis(const Vec3& dir, int degree, double* y);

/// L_lm of a probe. Each pixel is a constant over its exact cell: the basis is integrated over the cell, sums are in
/// double. Lat-longs by separable row moments; others by quadrature of each pixel.
Sh project(View<const float> rgb, const Projection& projection, int degree);

/// The light turned by R: rotated(sh, R) in direction R d is sh in direction d. Band by band, by the recurrence of
/// [Ivanic96] with its errata: exact at any degree. `rotation` must be orthonormal with determinant 1.
Sh rotated(const Sh& sh, const Mat3& rotation);

/// Radiance of the expansion in a direction.
Rgb evaluate(const Sh& sh, const Vec3& dir);

/// Irradiance at a surface with unit normal n: E_lm = A_l L_lm with A_l of [Ramamoorthi01] eq. 8 (A_0 = pi, A_1 =
/// 2pi/3, A_2 = pi/4, 0 for odd l > 1).
Rgb irradiance(const Sh& sh, const Vec3& n);

/// The symmetric matrices of E = (n,1)^T M (n,1), one a channel [Ramamoorthi01 eq. 12]; the lecture's eq. 17 with its
/// last row mended. Degree >= 2 needed for the quadratic part; missing coefficients count as 0.
std::array<Mat4, 3> irradiance_matrices(const Sh& sh);

/// The least irradiance of the expansion over all normals, per channel: below 0 it rings. A grid, and a search from its
/// lowest point.
Rgb least_irradiance(const Sh& sh);

/// What E is where nothing shades: tabulated on a lat-long of this size (pixel centres), negative values as 0.
Image<float> irradiance_map(const Sh& sh, Size size);

/// Rigorous bound on max |E - E_degree| over all normals, divided by the largest E of the expansion (the worst
/// channel): the bands that `sh` leaves out, up to degree 12, evaluated over the sphere, plus what lies beyond by
/// Cauchy-Schwarz or by the flux, whichever is smaller. Never below the true error; 0 for a black map. Directions that
/// the map does not show count as black. A windowed expansion is held against the same map: what the window took away
/// counts.
double irradiance_error_bound(View<const float> rgb, const Projection& projection, const Sh& sh);

/// The lowest degree whose bound is within `error` (relative to the largest E, > 0): a soft probe needs 1, a sun 4 or
/// more. `met` is false when even the highest that was tried, 12, has a larger bound; it is returned then.
struct ChosenSh {
  Sh sh;
  double bound = 0;
  bool met = true;
};
ChosenSh project_within(View<const float> rgb, const Projection& projection, double error);

}  // namespace hdr
