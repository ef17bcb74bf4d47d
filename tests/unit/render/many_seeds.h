// Probes of known light, and renders under many seeds: their means with standard errors.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "libhdr/core/color.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/render.h"

namespace hdr::test {

inline constexpr RenderMethod kUnbiased[] = {RenderMethod::kMc, RenderMethod::kImportance, RenderMethod::kMis};

inline Image<float> probe_of(Size size, const std::function<double(const Vec3&)>& radiance) {
  Image<float> map(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double value = radiance(dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height));
      for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(value * (1 + 0.1 * c));
    }
  }
  return map;
}

inline Environment constant_probe(double radiance) {
  return Environment(probe_of({16, 8}, [&](const Vec3&) { return radiance; }));
}

// Polynomials of degree 2: nine coefficients hold all of it but for the pixels' steps.
inline double soft_light(const Vec3& d) {
  return 1.2 + 0.6 * d.y() + 0.4 * d.x() * d.z() + 0.3 * d.z();
}

// Sky, a darker ground and a small bright sun: what makes methods differ.
inline double sunny_light(const Vec3& d) {
  const Vec3 sun = Vec3(0.5, 0.7, 0.6).normalized();
  return (d.y() > 0 ? 1.0 : 0.3) + (d.dot(sun) > std::cos(4 * kDegree) ? 150.0 : 0.0);
}

inline Environment soft_probe() {
  return Environment(probe_of({256, 128}, soft_light));
}

inline Environment sunny_probe() {
  return Environment(probe_of({128, 64}, sunny_light));
}

// Mean and its standard error of each pixel's luminance over renders with different seeds.
struct Truth {
  Image<double> mean, error, deviation;  ///< deviation: of one render
  Image<float> alpha;                    ///< the smallest of all seeds: 1 where no edge is near
};

inline Truth many_seeds(const Scene& scene, const Environment& light, RenderOptions options, int seeds) {
  Truth truth{Image<double>(options.size, 1), Image<double>(options.size, 1), Image<double>(options.size, 1),
              Image<float>(options.size, 1)};
  for (int seed = 0; seed < seeds; ++seed) {
    options.seed = 1000 + static_cast<std::uint64_t>(seed);
    const Rendering r = render(scene, light, options);
    for (int y = 0; y < options.size.height; ++y) {
      for (int x = 0; x < options.size.width; ++x) {
        const float* p = r.picture.rgb.pixel(x, y);
        const double value = luminance<double>(p[0], p[1], p[2]);
        const double step = value - truth.mean(x, y);
        truth.mean(x, y) += step / (seed + 1);
        truth.error(x, y) += step * (value - truth.mean(x, y));
      }
    }
    for (int y = 0; y < options.size.height; ++y) {
      for (int x = 0; x < options.size.width; ++x) {
        if (seed == 0 || r.picture.alpha(x, y) < truth.alpha(x, y)) truth.alpha(x, y) = r.picture.alpha(x, y);
      }
    }
  }
  for (int y = 0; y < options.size.height; ++y) {
    for (int x = 0; x < options.size.width; ++x) {
      truth.deviation(x, y) = std::sqrt(truth.error(x, y) / (seeds - 1));
      truth.error(x, y) = truth.deviation(x, y) / std::sqrt(static_cast<double>(seeds));
    }
  }
  return truth;
}

// z-scores of the difference of two estimates must look standard normal: bounds are those of 3 sigma for their mean,
// with room in the spread for standard errors that are themselves estimated.
inline void expect_same_light(const Truth& a, const Truth& b, const std::string& what) {
  double sum = 0, squares = 0, difference = 0, level = 0, error2 = 0;
  int count = 0;
  for (int y = 0; y < a.mean.height(); ++y) {
    for (int x = 0; x < a.mean.width(); ++x) {
      if (a.alpha(x, y) < 1) continue;
      const double d = a.mean(x, y) - b.mean(x, y);
      const double sigma = std::hypot(a.error(x, y), b.error(x, y)) + 1e-6 * a.mean(x, y);
      sum += d / sigma;
      squares += d * d / (sigma * sigma);
      difference += d;
      level += a.mean(x, y);
      error2 += sigma * sigma;
      ++count;
    }
  }
  ASSERT_GT(count, 100) << what;
  EXPECT_LT(std::abs(difference), 3 * std::sqrt(error2))
      << what << ": the pictures' means differ by " << 100 * difference / level << " %";
  EXPECT_LT(squares / count, 1.5) << what << ": mean square z-score of pixels";
}

// Mean and standard error over seeds of the picture's mean, of pixels that are always covered.
struct MeanLight {
  double mean = 0, error = 0;
};

inline MeanLight mean_light(const Scene& scene, const Environment& light, RenderOptions options, int seeds) {
  const Truth truth = many_seeds(scene, light, options, seeds);
  double squares = 0;
  MeanLight result;
  for (int seed = 0; seed < seeds; ++seed) {
    options.seed = 5000 + static_cast<std::uint64_t>(seed);
    const Rendering r = render(scene, light, options);
    double sum = 0;
    int count = 0;
    for (int y = 0; y < options.size.height; ++y) {
      for (int x = 0; x < options.size.width; ++x) {
        if (truth.alpha(x, y) < 1) continue;
        const float* p = r.picture.rgb.pixel(x, y);
        sum += luminance<double>(p[0], p[1], p[2]);
        ++count;
      }
    }
    const double step = sum / count - result.mean;
    result.mean += step / (seed + 1);
    squares += step * (sum / count - result.mean);
  }
  result.error = std::sqrt(squares / (seeds - 1) / seeds);
  return result;
}

}  // namespace hdr::test
