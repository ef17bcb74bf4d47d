#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/unwrap.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

Image<float> constant(Size size, float value) {
  Image<float> image(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width * 3; ++x) image.row(y)[x] = value;
  }
  return image;
}

/// Integral over the sphere of channel c.
double integral(const Image<float>& latlong, int c) {
  double total = 0;
  for (int y = 0; y < latlong.height(); ++y) {
    for (int x = 0; x < latlong.width(); ++x) {
      total += latlong(x, y, c) * latlong_pixel_solid_angle(y, latlong.width(), latlong.height());
    }
  }
  return total;
}

std::vector<std::pair<Projection, Size>> pictures() {
  return {{LatLong{{96, 48}}, {96, 48}},
          {LatLong{{301, 150}}, {301, 150}},
          {AngularMap{inscribed_disc(90)}, {90, 90}},
          {MirrorBall{{50.3, 44.8, 40}}, {100, 90}},
          {MirrorBall{{50.3, 44.8, 40}, 6}, {100, 90}},
          {Rectilinear{{80, 60}, 100}, {80, 60}}};
}

TEST(Resample, AConstantStaysConstantAndNothingElseAppears) {
  for (const auto& [from, from_size] : pictures()) {
    const Image<float> source = constant(from_size, 3.5f);
    for (const auto& [to, to_size] : pictures()) {
      const Image<float> result = resample(source, from, to, to_size, rotation_from_degrees({15, 30, -40}));
      int shown = 0;
      for (int y = 0; y < to_size.height; ++y) {
        for (int x = 0; x < to_size.width; ++x) {
          const float value = result(x, y, 1);
          shown += value > 0;
          ASSERT_TRUE(value == 0 || std::abs(value - 3.5f) < 1e-5f)
              << text_from_projection(from) << " -> " << text_from_projection(to) << " at " << x << "," << y << ": "
              << value;
        }
      }
      EXPECT_GT(shown, 100);
    }
  }
}

TEST(Resample, OnItsOwnGridAPictureIsCopied) {
  const Image<float> source = test::latlong_of(64, test::SoftRoom(5, 1));
  const Image<float> result = resample(source, LatLong{{64, 32}}, LatLong{{64, 32}}, {64, 32});
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64 * 3; ++x) EXPECT_NEAR(result.row(y)[x], source.row(y)[x], 1e-4 * source.row(y)[x]);
  }
}

TEST(Resample, TheIntegralOfASmoothMapIsKept) {
  const Image<float> source = test::latlong_of(512, test::SoftRoom(11));
  for (const int width : {64, 200, 512, 1024}) {
    const Mat3 turn = rotation_from_degrees({35, 71, 10});
    const Image<float> result =
        resample(source, LatLong{source.size()}, LatLong{{width, width / 2}}, {width, width / 2}, turn);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(integral(result, c) / integral(source, c), 1, 1e-3) << "width " << width;
  }
}

TEST(Resample, AWholeSphereGoesThroughEveryDiscAndBack) {
  const test::SoftRoom room(23);
  const Image<float> source = test::latlong_of(256, room);
  const std::vector<Projection> between = {AngularMap{inscribed_disc(500)}, MirrorBall{inscribed_disc(500)},
                                           MirrorBall{inscribed_disc(500), 8}};
  for (const Projection& projection : between) {
    const Image<float> picture = resample(source, LatLong{source.size()}, projection, {500, 500});
    const Image<float> back = resample(picture, projection, LatLong{{256, 128}}, {256, 128});
    for (int y = 0; y < 128; ++y) {
      for (int x = 0; x < 256; ++x) {
        const Vec3 d = dir_from_latlong((x + 0.5) / 256, (y + 0.5) / 128);
        if (d.z() < -std::cos(15 * kDegree)) continue;
        EXPECT_NEAR(std::log2(back(x, y, 0) / room(d, 0)), 0, 0.05)
            << text_from_projection(projection) << d.transpose();
      }
    }
  }
}

// The sampling grid may not miss source pixels: a sun of one pixel keeps its energy, wherever it falls. Its bilinear
// tents, summed on a grid that does not know where it is, add up to 1 within 9 % an axis; a wider sun does better.
TEST(Resample, ASunOfOnePixelKeepsItsEnergyWhenMinified) {
  Random random(4, 2);
  for (int trial = 0; trial < 8; ++trial) {
    Image<float> source = constant({1024, 512}, 0);
    const int x = static_cast<int>(random.bits() % 1024), y = 40 + static_cast<int>(random.bits() % 432);
    for (int c = 0; c < 3; ++c) source(x, y, c) = 1e5f;
    const Mat3 turn = rotation_from_degrees({360 * random.uniform(), 360 * random.uniform(), 0});
    const Image<float> result = resample(source, LatLong{source.size()}, LatLong{{150, 75}}, {150, 75}, turn);
    EXPECT_NEAR(integral(result, 0) / integral(source, 0), 1, 0.15) << "sun at " << x << "," << y;
  }
}

TEST(Resample, MagnifiedSunsDoNotRing) {
  Image<float> source = constant({64, 32}, 1);
  source(20, 15, 0) = 1e4f;
  const Image<float> result = resample(source, LatLong{source.size()}, AngularMap{inscribed_disc(600)}, {600, 600});
  for (int y = 0; y < 600; ++y) {
    for (int x = 0; x < 600; ++x)
      EXPECT_TRUE(result(x, y, 0) == 0 || (result(x, y, 0) > 0.9999f && result(x, y, 0) < 1.0001e4f));
  }
}

TEST(Resample, TheBackgroundBesideADiscDoesNotBleedIn) {
  Image<float> picture = constant({200, 180}, 1e6f);
  const Disc disc{97.3, 90.9, 70};
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (std::hypot(x + 0.5 - disc.cx, y + 0.5 - disc.cy) > disc.r - 0.7072) continue;
      for (int c = 0; c < 3; ++c) picture(x, y, c) = 2;
    }
  }
  for (const Projection& from :
       {Projection(AngularMap{disc}), Projection(MirrorBall{disc}), Projection(MirrorBall{disc, 4})}) {
    const Image<float> result = resample(picture, from, LatLong{{128, 64}}, {128, 64});
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 128; ++x) EXPECT_LE(result(x, y, 0), 2.0001f) << text_from_projection(from);
    }
  }
}

TEST(Resample, WhatTheSourceDoesNotShowIsZero) {
  const MirrorBall ball{inscribed_disc(200), 2};  // 30 degrees around -Z are hidden
  const Image<float> result = resample(constant({200, 200}, 1), ball, LatLong{{360, 180}}, {360, 180});
  EXPECT_EQ(result(0, 90, 0), 0);
  EXPECT_EQ(result(28, 90, 0), 0);
  EXPECT_FLOAT_EQ(result(31, 90, 0), 1);
  // A ball cut off by its picture shows only what is in the frame.
  const Image<float> cut = resample(constant({200, 200}, 1), MirrorBall{{100, 0, 90}}, LatLong{{360, 180}}, {360, 180});
  EXPECT_EQ(cut(180, 30, 0), 0);
  EXPECT_FLOAT_EQ(cut(180, 150, 0), 1);
}

TEST(Resample, TheBytesDoNotDependOnThreads) {
  const Image<float> source = test::latlong_of(256, test::SoftRoom(5, 1));
  const auto run = [&] { return resample(source, LatLong{source.size()}, MirrorBall{{101, 99, 95}, 7}, {200, 200}); };
  set_threads(1);
  const Image<float> one = run();
  set_threads(2);
  const Image<float> two = run();
  set_threads(0);
  for (int y = 0; y < 200; ++y) ASSERT_EQ(0, std::memcmp(one.row(y), two.row(y), one.row_samples() * sizeof(float)));
}

TEST(Resample, BadRequestsAreErrors) {
  const Image<float> source = constant({64, 32}, 1);
  const LatLong map{{64, 32}};
  EXPECT_THROW(resample(Image<float>(), map, map, {64, 32}), Error);
  EXPECT_THROW(resample(source, map, map, {0, 32}), Error);
  EXPECT_THROW(resample(source, map, MirrorBall{inscribed_disc(20), 0.9}, {20, 20}), Error);
  EXPECT_THROW(resample(source, map, map, {64, 32}, Mat3::Zero()), Error);
}

}  // namespace
}  // namespace hdr
