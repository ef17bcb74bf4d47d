// Rotation of real spherical harmonics, band by band [Ivanic96, with the errata of 1998]. Band 1 turns as y, z, x do;
// each further band's matrix follows from band 1 and the one before. The paper's symbols are kept.
#include <cmath>
#include <mutex>

#include "libhdr/light/internal/project.h"

namespace hdr {
namespace {

using Band = Eigen::MatrixXd;

double at(const Band& band, int m, int n) {
  const auto l = (band.rows() - 1) / 2;
  return band(m + l, n + l);
}

// Table 2 of the paper: P_i of degree l from band 1 and band l - 1.
double p_of(int i, int l, int a, int b, const Band& first, const Band& previous) {
  if (b == l) return at(first, i, 1) * at(previous, a, l - 1) - at(first, i, -1) * at(previous, a, 1 - l);
  if (b == -l) return at(first, i, 1) * at(previous, a, 1 - l) + at(first, i, -1) * at(previous, a, l - 1);
  return at(first, i, 0) * at(previous, a, b);
}

double v_of(int l, int m, int n, const Band& first, const Band& previous) {
  const auto p = [&](int i, int a) { return p_of(i, l, a, n, first, previous); };
  if (m == 0) return p(1, 1) + p(-1, -1);
  if (m > 0) return m == 1 ? std::sqrt(2.0) * p(1, 0) : p(1, m - 1) - p(-1, 1 - m);
  return m == -1 ? std::sqrt(2.0) * p(-1, 0) : p(1, m + 1) + p(-1, -m - 1);
}

double w_of(int l, int m, int n, const Band& first, const Band& previous) {
  const auto p = [&](int i, int a) { return p_of(i, l, a, n, first, previous); };
  return m > 0 ? p(1, m + 1) + p(-1, -m - 1) : p(1, m - 1) - p(-1, 1 - m);
}

double element(int l, int m, int n, const Band& first, const Band& previous) {
  const int size = std::abs(m);
  const double zero = m == 0 ? 1 : 0;
  const double d = std::abs(n) == l ? 2.0 * l * (2 * l - 1) : static_cast<double>((l + n) * (l - n));
  const double u = std::sqrt((l + m) * (l - m) / d);
  const double v = 0.5 * std::sqrt((1 + zero) * (l + size - 1) * (l + size) / d) * (1 - 2 * zero);
  const double w = -0.5 * std::sqrt((l - size - 1) * (l - size) / d) * (1 - zero);
  double sum = 0;
  if (u != 0) sum += u * p_of(0, l, m, n, first, previous);
  if (v != 0) sum += v * v_of(l, m, n, first, previous);
  if (w != 0) sum += w * w_of(l, m, n, first, previous);
  return sum;
}

Band band_after(int l, const Band& first, const Band& previous) {
  Band band(2 * l + 1, 2 * l + 1);
  for (int m = -l; m <= l; ++m)
    for (int n = -l; n <= l; ++n) band(m + l, n + l) = element(l, m, n, first, previous);
  return band;
}

Band first_band(const Mat3& rotation) {
  Band first(3, 3);
  constexpr int kAxis[] = {1, 2, 0};  // m = -1, 0, 1 are y, z, x
  for (int m = 0; m < 3; ++m)
    for (int n = 0; n < 3; ++n) first(m, n) = rotation(kAxis[m], kAxis[n]);
  return first;
}

void turn_band(int l, const Band& band, const Sh& sh, Sh& result) {
  for (int m = -l; m <= l; ++m) {
    Rgb sum = Rgb::Zero();
    for (int n = -l; n <= l; ++n) sum += at(band, m, n) * sh(l, n);
    result.coefficients[static_cast<std::size_t>(l * (l + 1) + m)] = sum;
  }
}

// Bands 1 to 32 of the turn from a lat-long's own axes, each made when it is first asked for.
const Band& band_of_world_from_map(int l) {
  static std::once_flag made[kMaxShDegree + 1];
  static Band bands[kMaxShDegree + 1];
  const auto k = static_cast<std::size_t>(l);
  std::call_once(made[k], [&] {
    const Mat3 world_from_map{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    bands[k] =
        l == 1 ? first_band(world_from_map) : band_after(l, band_of_world_from_map(1), band_of_world_from_map(l - 1));
  });
  return bands[k];
}

}  // namespace

Sh rotated(const Sh& sh, const Mat3& rotation) {
  Sh result = sh;
  const Band first = first_band(rotation);
  Band band = first;
  for (int l = 1; l <= sh.degree; ++l) {
    if (l > 1) band = band_after(l, first, band);
    turn_band(l, band, sh, result);
  }
  return result;
}

Sh world_from_map_frame(const Sh& map_frame) {
  Sh world = map_frame;
  for (int l = 1; l <= map_frame.degree; ++l) turn_band(l, band_of_world_from_map(l), map_frame, world);
  return world;
}

}  // namespace hdr
