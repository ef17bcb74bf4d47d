// Harmonics tabulated on a lat-long. In the map's own frame (pole +Y, azimuth from +Z) a row of
//   f = sum over m of C_m(theta) cos(m phi) + S_m(theta) sin(m phi)
// has one C_m and one S_m, the sums over l: a pixel costs 2 degree + 1 products instead of (degree + 1)^2.
#include "libhdr/light/sh_latlong.h"

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr {

Image<float> latlong_of(const Sh& sh, Size size) {
  HDR_ASSERT(size.width > 0 && size.height > 0);
  const Mat3 map_from_world{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  const Sh own = rotated(sh, map_from_world);
  const int degree = sh.degree, count = 2 * degree + 1;
  Eigen::MatrixXd waves(count, size.width);  // 1, cos phi, sin phi, cos 2 phi ... of pixel centres
  for (int x = 0; x < size.width; ++x) {
    const double phi = 2 * kPi * (0.5 - (x + 0.5) / size.width);
    waves(0, x) = 1;
    for (int m = 1; m <= degree; ++m) {
      waves(2 * m - 1, x) = std::cos(m * phi);
      waves(2 * m, x) = std::sin(m * phi);
    }
  }
  Image<float> map(size, 3);
  for_rows(size.height, 8, [&](int first, int last) {
    std::vector<double> basis(own.coefficients.size());
    for (int y = first; y < last; ++y) {
      const double theta = kPi * (y + 0.5) / size.height;
      sh_basis({std::sin(theta), 0, std::cos(theta)}, degree, basis.data());
      Eigen::MatrixXd row = Eigen::MatrixXd::Zero(3, count);
      for (int l = 0; l <= degree; ++l) {
        for (int m = 0; m <= l; ++m) {
          const double value = basis[static_cast<std::size_t>(l * (l + 1) + m)];
          row.col(m == 0 ? 0 : 2 * m - 1) += value * own(l, m).matrix();
          if (m > 0) row.col(2 * m) += value * own(l, -m).matrix();
        }
      }
      Eigen::Map<Eigen::Matrix3Xf>(map.row(y), 3, size.width) = (row * waves).cast<float>();
    }
  });
  return map;
}

}  // namespace hdr
