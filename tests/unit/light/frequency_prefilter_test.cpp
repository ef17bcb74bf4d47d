// The two ways of prefiltering agree where both can be right, and the bound holds where they cannot.
#include "libhdr/light/frequency_prefilter.h"

#include <gtest/gtest.h>

#include "libhdr/light/sh_latlong.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

Image<float> sun_map(Size size) {
  Image<float> map = test::constant_map(size, Rgbf(1, 1.2f, 1.5f));
  for (int c = 0; c < 3; ++c) map(size.width / 3, size.height / 4, c) = 1e5f;
  return map;
}

// The mean over every pixel's exact share of the lobe would be the truth; halves of the pixels' steps are near it.
Rgb by_quadrature(View<const float> map, const Vec3& d, double roughness, Lobe lobe, int split) {
  const double alpha2 = std::pow(roughness, 4), power = 2 / alpha2 - 2;
  Rgb sum = Rgb::Zero();
  double weight = 0;
  const int width = map.width() * split, height = map.height() * split;
  for (int y = 0; y < height; ++y) {
    const double solid_angle = latlong_pixel_solid_angle(y, width, height);
    for (int x = 0; x < width; ++x) {
      const double t = d.dot(dir_from_latlong((x + 0.5) / width, (y + 0.5) / height));
      if (t <= 0) continue;
      const double g = 0.5 * (1 + t) * (alpha2 - 1) + 1;
      const double w = solid_angle * (lobe == Lobe::kGgx ? t / (g * g) : std::pow(t, power));
      const float* p = map.pixel(x / split, y / split);
      sum += w * Rgb(p[0], p[1], p[2]);
      weight += w;
    }
  }
  return sum / weight;
}

// Positive, with nothing above degree 6 but what its pixels being constants adds.
Image<float> band_limited_map(Size size) {
  const Image<float> lobes = test::lobes_map({64, 32}, 5, 12, 9);
  return latlong_of(project(lobes, LatLong{lobes.size()}, 6), size);
}

TEST(FrequencyPrefilter, EqualsQuadratureAndSamplingOnABandLimitedProbe) {
  const Image<float> map = band_limited_map({256, 128});
  const FrequencyPrefilter frequency(map);
  const Prefilter sampling(map);
  Random random(5, 0);
  for (const Lobe lobe : {Lobe::kGgx, Lobe::kPhong}) {
    for (const double roughness : {0.4, 0.6, 0.8, 1.0}) {
      const auto level = frequency.level(roughness, lobe, 1e-3);
      ASSERT_TRUE(level.met) << roughness;
      EXPECT_LE(level.sh.degree, 7) << "the probe has no more";
      for (int k = 0; k < 10; ++k) {
        const Vec3 d = test::random_dir(random);
        const Rgb value = evaluate(level.sh, d), truth = by_quadrature(map, d, roughness, lobe, 1);
        EXPECT_LT((value / truth - 1).abs().maxCoeff(), 0.003) << roughness;
        EXPECT_LT((value / sampling.mean(d, roughness, lobe, 4096) - 1).abs().maxCoeff(), 0.01) << roughness;
      }
    }
  }
}

TEST(FrequencyPrefilter, AConstantIsDegreeNought) {
  const Image<float> grey = test::constant_map({64, 32}, Rgbf(0.5f, 2, 7));
  const FrequencyPrefilter prefilter(grey);
  for (const Lobe lobe : {Lobe::kGgx, Lobe::kPhong}) {
    for (const double roughness : {0.1, 0.5, 1.0}) {
      const auto level = prefilter.level(roughness, lobe, 1e-4);
      EXPECT_TRUE(level.met);
      EXPECT_EQ(level.sh.degree, 0);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(evaluate(level.sh, Vec3::UnitX())[c] / grey(0, 0, c), 1, 1e-6) << "light is neither lost nor made";
    }
  }
}

TEST(FrequencyPrefilter, TheBoundIsNeverBelowTheError) {
  const Image<float> maps[] = {test::lobes_map({128, 64}, 6, 200, 3), sun_map({128, 64})};
  Random random(7, 0);
  for (const Image<float>& map : maps) {
    const FrequencyPrefilter prefilter(map);
    for (const Lobe lobe : {Lobe::kGgx, Lobe::kPhong}) {
      for (const double roughness : {0.3, 0.5, 0.7, 1.0}) {
        for (const double error : {0.3, 0.05}) {
          const auto level = prefilter.level(roughness, lobe, error);
          EXPECT_EQ(level.met, level.bound <= error);
          double worst = 0, largest = 0;
          for (int k = 0; k < 15; ++k) {
            // Also straight at the sun, where it is largest.
            const Vec3 d = k == 0 ? dir_from_latlong(42.5 / 128, 16.5 / 64) : test::random_dir(random);
            const Rgb truth = by_quadrature(map, d, roughness, lobe, 2);
            worst = std::max(worst, std::abs(evaluate(level.sh, d)[1] - truth[1]));
            largest = std::max(largest, truth[1]);
          }
          EXPECT_LE(worst, level.bound * largest + 2e-3 * largest) << roughness << " " << error;
          if (error == 0.05 && level.met) {
            EXPECT_GT(level.sh.degree, 1);
          }
        }
      }
    }
  }
}

TEST(FrequencyPrefilter, SharpLobesOfASunAreNotPretended) {
  const FrequencyPrefilter prefilter(sun_map({128, 64}));
  const auto level = prefilter.level(0.2, Lobe::kGgx, 0.01);
  EXPECT_FALSE(level.met);
  EXPECT_EQ(level.sh.degree, kMaxShDegree);
  EXPECT_GT(level.bound, 0.3);
}

TEST(FrequencyPrefilter, BlackAndHugeMaps) {
  for (const float value : {0.0f, 1e30f}) {
    const Image<float> map = test::constant_map({16, 8}, Rgbf(value, value, value));
    const auto level = FrequencyPrefilter(map).level(0.5, Lobe::kGgx, 0.01);
    EXPECT_TRUE(level.met);
    EXPECT_NEAR(evaluate(level.sh, Vec3::UnitY())[0], value, 1e-6 * value);
  }
}

}  // namespace
}  // namespace hdr
