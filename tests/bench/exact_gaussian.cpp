#include "tests/bench/exact_gaussian.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/random.h"

namespace hdr::bench {

double exact_gaussian(const Image<float>& map, int x, int y, int c, double sigma) {
  const int reach = static_cast<int>(std::ceil(8 * sigma));
  const auto mirrored = [](int i, int n) {
    while (i < 0 || i >= n) i = i < 0 ? -1 - i : 2 * n - 1 - i;
    return i;
  };
  double sum = 0, total = 0;
  for (int dy = -reach; dy <= reach; ++dy) {
    const float* row = map.row(mirrored(y + dy, map.height()));
    const double wy = std::exp(-0.5 * dy * dy / (sigma * sigma));
    for (int dx = -reach; dx <= reach; ++dx) {
      const double w = wy * std::exp(-0.5 * dx * dx / (sigma * sigma));
      sum += w * row[3 * mirrored(x + dx, map.width()) + c];
      total += w;
    }
  }
  return sum / total;
}

double worst_gaussian_error(const Image<float>& map, const Image<float>& blurred, double sigma) {
  double worst = 0;
  Random random(5, 0);
  for (int k = 0; k < 12; ++k) {
    const int x = static_cast<int>(random.uniform() * map.width()),
              y = static_cast<int>(random.uniform() * map.height());
    const double truth = exact_gaussian(map, x, y, 1, sigma);
    worst = std::max(worst, std::abs(blurred(x, y, 1) - truth) / truth);
  }
  return worst;
}

}  // namespace hdr::bench
