#include "libhdr/probe/unwrap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

Image<float> constant(Size size, float value, int channels = 3) {
  Image<float> image(size, channels);
  for (int y = 0; y < size.height; ++y) std::fill_n(image.row(y), size.width * channels, value);
  return image;
}

TEST(Unwrap, KeepsTheTagsAndNamesTheProjection) {
  RadianceMap map;
  map.rgb = constant({100, 100}, 2);
  map.white_luminance = 80;
  map.projection = "mirror-ball";
  const RadianceMap probe = unwrap(map, MirrorBall{inscribed_disc(100)}, LatLong{{64, 32}}, {64, 32});
  EXPECT_EQ(probe.projection, "latlong");
  EXPECT_EQ(probe.white_luminance, 80);
  EXPECT_EQ(probe.size(), (Size{64, 32}));
  EXPECT_TRUE(probe.alpha.empty()) << "a far ball shows everything";
  EXPECT_TRUE(probe.stddev.empty());
}

// What the deviations say is how far noisy pictures are from the one without noise: the mean square of error over
// deviation is 1 over all pixels, whichever kernel they have.
TEST(Unwrap, DeviationsAreThoseOfTheNoise) {
  struct Case {
    Projection from;
    Size from_size;
    Projection to;
    Size to_size;
    const char* which;
  };
  const std::vector<Case> cases = {
      {LatLong{{256, 128}}, {256, 128}, LatLong{{400, 200}}, {400, 200}, "made larger"},
      {LatLong{{256, 128}}, {256, 128}, LatLong{{64, 32}}, {64, 32}, "made smaller"},
      {MirrorBall{{90, 90, 85}, 8}, {180, 180}, LatLong{{160, 80}}, {160, 80}, "a ball"},
      {Fisheye{{90, 90, 85}, 190}, {180, 180}, Rectilinear{{90, 60}, 70}, {90, 60}, "a fisheye"}};
  const Mat3 turn = rotation_from_degrees({10, 33, -5});
  for (const Case& c : cases) {
    RadianceMap map;
    map.stddev = Image<float>(c.from_size, 3);
    for (int y = 0; y < c.from_size.height; ++y) {
      for (int x = 0; x < 3 * c.from_size.width; ++x) map.stddev.row(y)[x] = 0.2f + 0.002f * static_cast<float>(x + y);
    }
    constexpr int kDraws = 24;
    Random random(5, 77);
    double squares = 0;
    std::int64_t count = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      map.rgb = constant(c.from_size, 100);
      for (int y = 0; y < c.from_size.height; ++y) {
        float *row = map.rgb.row(y), *deviation = map.stddev.row(y);
        for (int x = 0; x < 3 * c.from_size.width; ++x) row[x] += deviation[x] * static_cast<float>(random.normal());
      }
      const RadianceMap out = unwrap(map, c.from, c.to, c.to_size, turn);
      for (int y = 0; y < c.to_size.height; ++y) {
        for (int x = 0; x < c.to_size.width; ++x) {
          if (!out.alpha.empty() && out.alpha(x, y) == 0) continue;
          for (int k = 0; k < 3; ++k) {
            const double off = (out.rgb(x, y, k) - 100.0) / static_cast<double>(out.stddev(x, y, k));
            squares += off * off;
            ++count;
          }
        }
      }
    }
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count)), 1, 0.02) << c.which;
  }
}

TEST(Unwrap, AlphaIsWhereTheSourceShowsSomething) {
  RadianceMap map;
  map.rgb = constant({200, 200}, 1);
  const Size size{360, 180};
  const Projection latlong = LatLong{size};
  // 30 degrees around -Z are hidden by the ball.
  const RadianceMap near = unwrap(map, MirrorBall{inscribed_disc(200), 2}, latlong, size);
  ASSERT_FALSE(near.alpha.empty());
  EXPECT_EQ(near.alpha(0, 90), 0);
  EXPECT_EQ(near.alpha(28, 90), 0);
  EXPECT_EQ(near.alpha(32, 90), 1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) EXPECT_EQ(near.alpha(x, y) > 0, near.rgb(x, y, 0) > 0) << x << " " << y;
  }
  // A part of the sphere, there and back.
  const Panorama part{{180, 120}, 90, 60, 30, 10};
  RadianceMap scan;
  scan.rgb = constant(part.size, 1);
  const RadianceMap sphere = unwrap(scan, part, latlong, size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool there = part.px_from_dir(dir_from_latlong((x + 0.5) / 360, (y + 0.5) / 180)).has_value();
      EXPECT_EQ(sphere.alpha(x, y), there ? 1.0f : 0.0f) << x << " " << y;
    }
  }
  const RadianceMap back = unwrap(sphere, latlong, part, part.size);
  EXPECT_FLOAT_EQ(back.alpha(90, 60), 1);
  // What is asked for is shown: no alpha.
  EXPECT_TRUE(unwrap(scan, part, Panorama{{40, 20}, 40, 20, 30, 10}, {40, 20}).alpha.empty());
}

TEST(Unwrap, APanoramaOfAFullTurnHasNoSeam) {
  const test::SoftRoom room(4, 0.4);
  const Image<float> whole = test::latlong_of(512, room);
  const Panorama scan{{512, 170}, 360, 119.53125, 0, 0};
  RadianceMap map;
  map.rgb = Image<float>(scan.size, 3);
  for (int y = 0; y < 170; ++y) std::copy_n(whole.row(y + 43), 3 * 512, map.rgb.row(y));
  const Size size{512, 256};
  const Mat3 turn = rotation_from_degrees({0, 180, 0});
  const RadianceMap turned = unwrap(map, scan, LatLong{size}, size, turn);
  for (int x = 240; x < 272; ++x) {
    const double truth = room(turn * dir_from_latlong((x + 0.5) / 512, (100 + 0.5) / 256), 1);
    EXPECT_NEAR(turned.rgb(x, 100, 1) / truth, 1, 0.01) << x;
  }
}

}  // namespace
}  // namespace hdr
