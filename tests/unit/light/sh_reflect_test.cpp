#include "libhdr/light/sh_reflect.h"

#include <gtest/gtest.h>

#include "libhdr/light/sh_latlong.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

TEST(ShReflect, TheClampedCosineIsIrradiance) {
  const Image<float> map = test::lobes_map({64, 32}, 4, 40, 2);
  const Sh light = project(map, LatLong{map.size()}, 9);
  const Sh e = convolved(light, [](double t) { return std::max(0.0, t); });
  Random random(1, 0);
  for (int k = 0; k < 50; ++k) {
    const Vec3 n = test::random_dir(random);
    EXPECT_LT((evaluate(e, n) / irradiance(light, n) - 1).abs().maxCoeff(), 1e-6);
  }
}

TEST(ShReflect, PhongKeepsAFurnaceAndSeesWhatBruteForceSees) {
  const Image<float> map = test::lobes_map({128, 64}, 5, 30, 4);
  const Sh light = project(map, LatLong{map.size()}, kMaxShDegree);
  Random random(2, 0);
  for (const double exponent : {0.0, 1.0, 10.0, 40.0}) {
    const Sh reflected = phong_reflected(light, exponent);
    EXPECT_LT((reflected(0, 0) / light(0, 0) - 1).abs().maxCoeff(), 1e-9) << "light is neither lost nor made";
    for (int k = 0; k < 8; ++k) {
      const Vec3 d = test::random_dir(random);
      Rgb sum = Rgb::Zero();
      double weight = 0;
      for (int y = 0; y < 2 * map.height(); ++y) {
        const double solid_angle = latlong_pixel_solid_angle(y, 2 * map.width(), 2 * map.height());
        for (int x = 0; x < 2 * map.width(); ++x) {
          const double t = d.dot(dir_from_latlong((x + 0.5) / (2 * map.width()), (y + 0.5) / (2 * map.height())));
          if (t <= 0) continue;
          const double w = solid_angle * std::pow(t, exponent);
          const float* p = map.pixel(x / 2, y / 2);
          sum += w * Rgb(p[0], p[1], p[2]);
          weight += w;
        }
      }
      EXPECT_LT((evaluate(reflected, d) * weight / sum - 1).abs().maxCoeff(), 0.004) << exponent;
    }
  }
}

// [Ramamoorthi01b] eq. 26: k_l of a normalised Phong lobe are products of ratios,
//   even l:  s (s - 2) ... (s - l + 2) / ((s + 3) (s + 5) ... (s + l + 1)),
//   odd l:   (s + 1) (s - 1) ... (s - l + 2) / ((s + 2) (s + 4) ... (s + l + 1)),
// and nearly exp(-l^2 / 2s) while l^2 is of the order of s.
TEST(ShReflect, PhongsBandsAreThePapers) {
  for (const double s : {1.0, 2.5, 10.0, 100.0, 1000.0}) {
    const std::vector<double> k =
        kernel_bands([s](double t) { return t > 0 ? (s + 1) / (2 * kPi) * std::pow(t, s) : 0.0; }, 20);
    double even = 1, odd = (s + 1) / (s + 2);
    for (int l = 0; l <= 20; l += 2) {
      EXPECT_NEAR(k[static_cast<std::size_t>(l)], even, 1e-7) << s << " " << l;
      if (l < 20) {
        EXPECT_NEAR(k[static_cast<std::size_t>(l + 1)], odd, 1e-7) << s << " " << l + 1;
      }
      even *= (s - l) / (s + l + 3);
      odd *= (s - l - 1) / (s + l + 4);
    }
  }
  const auto k = kernel_bands([](double t) { return t > 0 ? 65 / (2 * kPi) * std::pow(t, 64) : 0.0; }, 8);
  const double pinned[] = {1, 65.0 / 66, 64.0 / 67, 65.0 * 63 / (66.0 * 68), 64.0 * 62 / (67.0 * 69)};
  for (std::size_t l = 0; l < 5; ++l) EXPECT_NEAR(k[l], pinned[l], 1e-12);
  for (std::size_t l = 0; l <= 8; ++l)
    EXPECT_NEAR(k[l], std::exp(-static_cast<double>(l * l) / 128), 0.04) << "the paper's exponential";
}

TEST(ShReflect, ALatLongOfHarmonicsIsTheirValues) {
  const Image<float> map = test::lobes_map({64, 32}, 4, 40, 2);
  for (const int degree : {0, 1, 5, kMaxShDegree}) {
    const Sh sh = project(map, LatLong{map.size()}, degree);
    const Image<float> table = latlong_of(sh, {33, 17});
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 33; ++x) {
        const Rgb value = evaluate(sh, dir_from_latlong((x + 0.5) / 33, (y + 0.5) / 17));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(table(x, y, c), value[c], 2e-6) << degree;
      }
    }
  }
}

}  // namespace
}  // namespace hdr
