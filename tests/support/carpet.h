#pragma once
// A scene that can be recognised everywhere.
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"

namespace hdr::test {

/// Radiance of many waves, down to three degrees long, around 1.
class Carpet {
 public:
  explicit Carpet(std::uint64_t seed = 8) {
    Random random(seed, 21);
    for (int n = 0; n < 28; ++n) {
      const double z = 2 * random.uniform() - 1, azimuth = 2 * kPi * random.uniform(), r = std::sqrt(1 - z * z);
      const Vec3 dir(r * std::cos(azimuth), r * std::sin(azimuth), z);
      waves_.push_back({dir * (10 + 100 * random.uniform()), 2 * kPi * random.uniform()});
    }
  }
  double operator()(const Vec3& d) const {
    double sum = 0;
    for (const auto& [k, phase] : waves_) sum += std::sin(k.dot(d) + phase);
    return std::exp(0.22 * sum);
  }

 private:
  std::vector<std::pair<Vec3, double>> waves_;
};

}  // namespace hdr::test
