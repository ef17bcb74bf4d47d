// The fit errs less than the projection at its worst normal, and finds what can be met exactly.
#include "libhdr/light/sh_fit.h"

#include <gtest/gtest.h>

#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

double largest_error(View<const float> map, const Sh& sh) {
  double worst = 0, largest = 0;
  Random random(3, 1);
  for (int k = 0; k < 300; ++k) {
    const Vec3 n = test::random_dir(random);
    const double truth = test::brute_force_irradiance(map, n)[1];
    largest = std::max(largest, truth);
    worst = std::max(worst, std::abs(irradiance(sh, n)[1] - truth));
  }
  return worst / largest;
}

// A sun alone: its irradiance is max(t, 0) of the cosine t, which the projection (1/4 + t/2 + 5/16 P_2) misses by 3/32
// where the shadow begins. max(t, 0) = (t + |t|) / 2, and of all parabolas t^2 + 1/8 is closest to |t|, within 1/8.
TEST(ShFit, OfASunTheBestParabolaIsFound) {
  Image<float> map = test::constant_map({512, 256}, Rgbf::Zero());
  for (int c = 0; c < 3; ++c) map(200, 100, c) = 1e6f;
  const FittedSh fit = fit_irradiance(map, 2);
  EXPECT_NEAR(fit.error, 1.0 / 16, 0.002);
  EXPECT_NEAR(fit.projected, 3.0 / 32, 0.002);
  EXPECT_LT(largest_error(map, fit.sh), 1.0 / 16 + 0.002);
}

TEST(ShFit, ErrsLessThanTheProjectionAndKeepsWhatIsExact) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Image<float> map = test::lobes_map({64, 32}, 4, 200, seed);
    for (const int degree : {1, 2, 4}) {
      const FittedSh fit = fit_irradiance(map, degree);
      EXPECT_LE(fit.error, fit.projected);
      EXPECT_LT(largest_error(map, fit.sh), 1.1 * largest_error(map, project(map, LatLong{map.size()}, degree)));
    }
  }
  const Image<float> grey = test::constant_map({64, 32}, Rgbf(1, 2, 3));
  const FittedSh fit = fit_irradiance(grey, 2);
  EXPECT_NEAR(irradiance(fit.sh, Vec3::UnitX())[2], 3 * kPi, 0.01);
  EXPECT_EQ(fit_irradiance(test::constant_map({16, 8}, Rgbf::Zero()), 2).error, 0);
}

}  // namespace
}  // namespace hdr
