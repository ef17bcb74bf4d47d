#pragma once
// Maps made for tests of light.
#include <cmath>
#include <functional>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/sh.h"

namespace hdr::test {

inline Image<float> constant_map(Size size, const Rgbf& radiance) {
  Image<float> map(size, 3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < 3; ++c) map(x, y, c) = radiance[c];
  return map;
}

/// Each pixel of a lat-long takes f(direction of its centre) in all channels.
inline Image<float> latlong_map(Size size, const std::function<double(const Vec3&)>& f) {
  Image<float> map(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double value = f(dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height));
      for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(value);
    }
  }
  return map;
}

inline Vec3 random_dir(Random& random) {
  const Vec3 d(random.normal(), random.normal(), random.normal());
  return d.normalized();
}

/// A few lobes of random direction, width and colour on a dim ground; sharpness up to `sharpest`.
inline Image<float> lobes_map(Size size, int lobes, double sharpest, std::uint64_t seed) {
  Random random(seed, 77);
  Image<float> map = constant_map(size, Rgbf(0.1f, 0.12f, 0.15f));
  for (int i = 0; i < lobes; ++i) {
    const Vec3 axis = random_dir(random);
    const double sharpness = std::exp(random.uniform() * std::log(sharpest));
    const Rgb colour(0.2 + random.uniform(), 0.2 + random.uniform(), 0.2 + random.uniform());
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const Vec3 d = dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height);
        const double value = std::exp(sharpness * (d.dot(axis) - 1));
        for (int c = 0; c < 3; ++c) map(x, y, c) += static_cast<float>(value * colour[c]);
      }
    }
  }
  return map;
}

/// Irradiance by summing every pixel: midpoints of `split` x `split` parts of each pixel.
inline Rgb brute_force_irradiance(View<const float> latlong, const Vec3& n, int split = 1) {
  Rgb sum = Rgb::Zero();
  const int width = latlong.width() * split, height = latlong.height() * split;
  for (int y = 0; y < height; ++y) {
    const double solid_angle = latlong_pixel_solid_angle(y, width, height);
    for (int x = 0; x < width; ++x) {
      const double cosine = n.dot(dir_from_latlong((x + 0.5) / width, (y + 0.5) / height));
      if (cosine <= 0) continue;
      const float* p = latlong.pixel(x / split, y / split);
      sum += cosine * solid_angle * Rgb(p[0], p[1], p[2]);
    }
  }
  return sum;
}

}  // namespace hdr::test
