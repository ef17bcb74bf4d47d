#include "libhdr/light/sh_reflect.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hdr
