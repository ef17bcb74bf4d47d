#include "libhdr/light/horizontal_irradiance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

TEST(HorizontalIrradiance, ConstantSkyGivesPiLForAnyHeight) {
  for (const int height : {1, 2, 7, 16, 33}) {
    const Rgb e = horizontal_irradiance(test::constant_map({2 * height, height}, {2.0f, 0.5f, 7.0f}));
    EXPECT_NEAR(e[0], 2 * kPi, 1e-9) << height;
    EXPECT_NEAR(e[2], 7 * kPi, 1e-9) << height;
  }
}

TEST(HorizontalIrradiance, ASmallSunGivesRadianceTimesSolidAngleTimesCosine) {
  const Size size{720, 360};
  for (const int row : {10, 90, 179, 180, 300}) {
    Image<float> map(size, 3);
    map(100, row, 1) = 5000;
    const double cosine = std::cos(kPi * (row + 0.5) / size.height);
    const double expected = 5000 * latlong_pixel_solid_angle(row, size.width, size.height) * std::max(0.0, cosine);
    EXPECT_NEAR(horizontal_irradiance(map)[1], expected, 1e-4 * expected + 1e-12) << row;
  }
}

TEST(HorizontalIrradiance, IsThatOfTheHarmonicsUpToWhatDegreeTwelveLeavesOut) {
  const Image<float> map = test::lobes_map({128, 64}, 6, 20, 3);
  const Rgb exact = horizontal_irradiance(map);
  const Rgb series = irradiance(project(map, LatLong{map.size()}, 12), {0, 1, 0});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(series[c] / exact[c], 1, 3e-3);
}

// Of the row above the horizon sin^2 - sin^2 would keep half of the digits.
TEST(HorizontalIrradiance, DoesNotCancelAtTheHorizon) {
  const int height = 4096;
  Image<float> map(2, height, 3);
  map(0, height / 2 - 1, 0) = 1;
  const double s = std::sin(kPi / height);  // cos^2 of the row's upper edge
  EXPECT_NEAR(horizontal_irradiance(map)[0] / (0.5 * kPi * s * s), 1, 1e-12);
}

}  // namespace
}  // namespace hdr
