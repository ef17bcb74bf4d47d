// The exposure formula, pinned.
#include "libhdr/core/photometry.h"

#include <gtest/gtest.h>

namespace hdr {
namespace {

TEST(Photometry, SunnySixteen) {
  // 1/100 s at f/16 and ISO 100 meters a scene of K N^2 / (t S) = 12.5 * 256 * 100 / 100 cd/m^2.
  const Exposure sunny{1.0 / 100, 16, 100};
  EXPECT_NEAR(luminance_of_unit_radiance(*sunny.relative()), 3200, 1e-9);
}

TEST(Photometry, MoreLightLetInIsLessLuminance) {
  const Exposure base{1.0 / 100, 16, 100};
  const double bright = luminance_of_unit_radiance(*base.relative());
  for (const Exposure& stop : {Exposure{1.0 / 50, 16, 100}, Exposure{1.0 / 100, 16, 200}}) {
    EXPECT_NEAR(luminance_of_unit_radiance(*stop.relative()), bright / 2, 1e-9);
  }
  EXPECT_NEAR(luminance_of_unit_radiance(*Exposure{1.0 / 100, 8, 100}.relative()), bright / 4, 1e-9);
  EXPECT_NEAR(luminance_of_unit_radiance(*Exposure{1.0 / 100, 16, 100, 3}.relative()), bright * 8, 1e-9)
      << "behind a filter of three stops the scene is eight times as bright";
}

TEST(Photometry, NothingIsSaidUnlessTimeApertureAndIsoAreKnown) {
  Bracket bracket;
  for (int k = 0; k < 2; ++k) {
    Photo photo;
    photo.exposure = {0.01 * (k + 1), 8, 100};
    bracket.shots.push_back(std::move(photo));
  }
  EXPECT_NEAR(white_luminance(bracket, 1e-4).value(), 1250, 1e-9);
  for (const auto setting : {&Exposure::f_number, &Exposure::iso}) {
    const auto kept = std::exchange(bracket.shots[1].exposure.*setting, std::nullopt);
    EXPECT_FALSE(white_luminance(bracket, 1e-4).has_value());
    bracket.shots[1].exposure.*setting = kept;
  }
  EXPECT_FALSE(white_luminance({}, 1e-4).has_value()) << "no shots, no exposure";
}

}  // namespace
}  // namespace hdr
