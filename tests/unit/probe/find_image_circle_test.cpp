#include "libhdr/probe/find_image_circle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/photograph.h"
#include "tests/support/rounds.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

struct Fisheye {
  Disc disc;
  double blur_px = 1;     ///< of the rim
  double dark = 1e-3;     ///< the surround, of the scene's median
  double noise = 0.02;    ///< share of a pixel's value, and a tenth of `dark`
  double vignetting = 0;  ///< light lost at the rim
  bool dark_half = false;
  bool flare = false;  ///< light that reaches over the rim
};

double smooth_step(double x) {
  const double t = std::clamp(0.5 + 0.5 * x, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// A textured room within the disc.
Image<float> photograph(Size size, const Fisheye& lens, std::uint64_t seed) {
  const test::SoftRoom room(seed, 0.4);
  Image<float> picture(size, 3);
  for (int y = 0; y < size.height; ++y) {
    Random random(seed, 7, static_cast<std::uint64_t>(y));
    for (int x = 0; x < size.width; ++x) {
      const Vec2 from_centre(x + 0.5 - lens.disc.cx, y + 0.5 - lens.disc.cy);
      const double r = from_centre.norm() / lens.disc.r, angle = 95 * kDegree * r;
      const Vec2 u = r > 0 ? Vec2(from_centre / from_centre.norm()) : Vec2(1, 0);
      const Vec3 d(-std::sin(angle) * u.x(), -std::sin(angle) * u.y(), std::cos(angle));
      double light = smooth_step((1 - r) * lens.disc.r / lens.blur_px) * (1 - lens.vignetting * r * r * r * r);
      if (lens.dark_half && from_centre.x() < 0) light *= 1e-4;
      const double flare = lens.flare ? 0.5 * std::exp(-(from_centre - Vec2(0, -lens.disc.r)).squaredNorm() / 900) : 0;
      for (int c = 0; c < 3; ++c) {
        const double value = light * room(d, c) + flare + lens.dark;
        picture(x, y, c) =
            static_cast<float>(std::max(0.0, value + lens.noise * (value + 0.1 * lens.dark) * random.normal()));
      }
    }
  }
  return picture;
}

void expect_found(Size size, const Fisheye& lens, std::uint64_t seed, const std::string& which) {
  const auto found = find_image_circle(photograph(size, lens, seed));
  ASSERT_TRUE(found) << which << ": none found";
  EXPECT_LT(std::hypot(found->disc.cx - lens.disc.cx, found->disc.cy - lens.disc.cy), 0.5) << which;
  EXPECT_NEAR(found->disc.r, lens.disc.r, 0.5) << which;
  EXPECT_LT(found->residual_px, 1) << which;
}

TEST(FindImageCircle, PlacesTheRimWithinHalfAPixel) {
  for (std::uint64_t seed = 1; seed < 1 + test::rounds(12); ++seed) {
    Random random(seed, 1);
    const Size size{640 + static_cast<int>(200 * random.uniform()), 600};
    Fisheye lens;
    lens.disc = {0.5 * size.width + 30 * random.uniform() - 15, 300 + 30 * random.uniform() - 15,
                 180 + 150 * random.uniform()};
    lens.blur_px = 0.5 + 2 * random.uniform();
    lens.dark = std::exp(-8 * random.uniform() - 3.5);
    lens.noise = 0.05 * random.uniform();
    expect_found(size, lens, seed, "seed " + std::to_string(seed));
  }
}

TEST(FindImageCircle, MayBeCutHalfDarkOrUnderFlare) {
  expect_found({700, 460}, {{350, 230, 290}}, 21, "cut above and below");
  expect_found({640, 480}, {{330, 236, 260}, 1, 1e-3, 0.02, 0, true}, 22, "half the picture dark");
  expect_found({640, 480}, {{322, 250, 200}, 1, 1e-3, 0.02, 0, false, true}, 23, "flare over the rim");
  expect_found({640, 640}, {{318, 322, 300}, 2, 1e-4, 0.01, 0.5}, 24, "vignetting");
}

TEST(FindImageCircle, APictureThatFillsItsFrameHasNone) {
  for (std::uint64_t seed = 31; seed < 31 + test::rounds(4); ++seed) {
    const Image<float> scene = test::latlong_of(512, test::SoftRoom(seed, 0.5));
    EXPECT_FALSE(find_image_circle(scene)) << "a lat-long";
    EXPECT_FALSE(find_image_circle(photograph_view(scene, {640, 480}, 60))) << "a photograph";
  }
  Image<float> picture(300, 200, 3);
  EXPECT_FALSE(find_image_circle(picture)) << "black";
  for (int y = 0; y < 200; ++y) std::fill_n(picture.row(y), 900, 0.5f);
  EXPECT_FALSE(find_image_circle(picture)) << "flat";
  for (int y = 0; y < 200; ++y) std::fill_n(picture.row(y), 900, y > 60 && y < 140 ? 0.5f : 0.0f);
  EXPECT_FALSE(find_image_circle(picture)) << "a band of light";
  EXPECT_FALSE(find_image_circle(Image<float>(1, 1, 3)));
  EXPECT_FALSE(find_image_circle(Image<float>()));
}

}  // namespace
}  // namespace hdr
