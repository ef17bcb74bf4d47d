#pragma once
// Environments with known values: seeded sums of a few smooth lobes, with texture and a sun when asked for.
#include <cmath>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"

namespace hdr::test {

inline Vec3 random_direction(Random& random) {
  const double z = 2 * random.uniform() - 1, azimuth = 2 * kPi * random.uniform(), s = std::sqrt(1 - z * z);
  return {s * std::cos(azimuth), s * std::sin(azimuth), z};
}

/// Fills a lat-long with radiance(direction), one channel a call of radiance(direction, channel).
template <class Radiance>
Image<float> latlong_of(int width, const Radiance& radiance) {
  Image<float> map(width, width / 2, 3);
  for_rows(width / 2, 8, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width; ++x) {
        const Vec3 d = dir_from_latlong((x + 0.5) / width, (y + 0.5) / (0.5 * width));
        for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(radiance(d, c));
      }
    }
  });
  return map;
}

/// A room of soft lobes, about 4 stops deep. `texture` adds plane waves of wavelengths down to 4 degrees.
class SoftRoom {
 public:
  explicit SoftRoom(std::uint64_t seed, double texture = 0) : texture_(texture) {
    Random random(seed, 0);
    for (int k = 0; k < 8; ++k) {
      lobes_.push_back({random_direction(random), 2 + 12 * random.uniform(), 3 * random.uniform() - 1});
    }
    for (int k = 0; k < 8; ++k) {
      const double wavelength = 4 * kDegree * std::exp2(3 * random.uniform());
      waves_.push_back({random_direction(random) * (2 * kPi / wavelength), 2 * kPi * random.uniform()});
    }
  }

  double operator()(const Vec3& d, int channel) const {
    double log_radiance = 0.15 * (channel - 1) * d.y();
    for (const Lobe& lobe : lobes_) log_radiance += lobe.strength * std::exp(lobe.sharpness * (d.dot(lobe.centre) - 1));
    double waves = 0;
    if (texture_ == 0) return std::exp(log_radiance);
    for (const Wave& wave : waves_) waves += std::sin(wave.k.dot(d) + wave.phase);
    return std::exp(log_radiance + texture_ * waves / std::sqrt(4.0));
  }

 private:
  struct Lobe {
    Vec3 centre;
    double sharpness, strength;
  };
  struct Wave {
    Vec3 k;
    double phase;
  };
  double texture_;
  std::vector<Lobe> lobes_;
  std::vector<Wave> waves_;
};

}  // namespace hdr::test
