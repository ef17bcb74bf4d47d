#include "libhdr/response/internal/observations.h"

#include <cmath>

namespace hdr {

UsableCodes usable_codes(int bits, bool lossy) {
  // In 8-bit terms: 2..249 of 255; JPEG smears what is next to black and white, so 4..247 there.
  const double unit = (std::ldexp(1.0, bits) - 1) / 255;
  return lossy ? UsableCodes{4 * unit, 247 * unit} : UsableCodes{2 * unit, 249 * unit};
}

Eigen::MatrixXd rows_seen_twice(const Eigen::MatrixXd& codes, const Eigen::VectorXd& ln_exposure) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    double least = INFINITY, most = -INFINITY;
    for (Eigen::Index j = 0; j < codes.cols(); ++j) {
      if (std::isnan(codes(i, j))) continue;
      least = std::min(least, ln_exposure[j]);
      most = std::max(most, ln_exposure[j]);
    }
    if (most - least > 1e-3) kept.push_back(i);
  }
  return codes(kept, Eigen::all);
}

}  // namespace hdr
