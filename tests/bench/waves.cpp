#include "tests/bench/waves.h"

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"

namespace hdr::bench {

World::World(double most_waves) {
  Random random(3, 7);
  for (int n = 0; n < 10; ++n) {
    const double z = 2 * random.uniform() - 1, a = 2 * kPi * random.uniform(), s = std::sqrt(1 - z * z);
    waves_.push_back({Vec3(s * std::cos(a), s * std::sin(a), z) * (most_waves * std::sqrt(random.uniform())),
                      2 * kPi * random.uniform()});
  }
}

void World::at(const Vec3& d, float* rgb) const {
  double sum[3] = {0, 0, 0};
  for (const auto& [k, phase] : waves_) {
    const double a = k.dot(d) + phase, s = std::sin(a), c = std::cos(a);
    sum[0] += s;
    sum[1] += c;
    sum[2] += 0.7 * (s + c);
  }
  for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(1 + 0.1 * sum[c]);
}

Image<float> picture_of(const World& world, const Projection& projection, Size size) {
  Image<float> picture(size, 3);
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        if (const auto d = dir_from_px(projection, {x + 0.5, y + 0.5})) world.at(*d, picture.pixel(x, y));
      }
    }
  });
  return picture;
}

}  // namespace hdr::bench
