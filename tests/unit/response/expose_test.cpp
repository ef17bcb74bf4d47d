#include "libhdr/response/expose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "tests/unit/response/simulated.h"

namespace hdr {
namespace {

using test::shutter;

constexpr NoiseModel kNoNoise{1e12, 0};

Image<float> constant(int width, int height, float value) {
  Image<float> image(width, height, 3);
  for (int y = 0; y < height; ++y) std::fill_n(image.row(y), width * 3, value);
  return image;
}

int code_at(const Photo& photo, int x, int y, int c) {
  return std::visit([&](const auto& image) -> int { return image(x, y, c); }, photo.codes);
}

// g and expose() are inverses: light exp(g(Z)) gives code Z.
TEST(Expose, TheExposureOfACodeGivesThatCode) {
  for (const char* name : {"linear", "srgb", "gamma:2.2", "film"}) {
    for (const int bits : {8, 12, 16}) {
      const Response response = *response_from_name(name, bits);
      const int codes = 1 << bits;
      Image<float> light(codes, 1, 3);
      for (int c = 0; c < 3; ++c) {
        const double full_well = response.exposure(c, codes - 1);
        for (int z = 0; z < codes; ++z) light(z, 0, c) = static_cast<float>(response.exposure(c, z) / full_well);
      }
      const Photo photo = expose(light, shutter(1), {response, kNoNoise, 1}, 1);
      EXPECT_EQ(photo.bits, bits);
      for (int c = 0; c < 3; ++c) {
        for (int z = 0; z < codes; ++z) {
          if (bits == 16 && z < 16) continue;  // below the second sample cells may be narrower than a float's rounding
          ASSERT_EQ(code_at(photo, z, 0, c), z) << name << ", " << bits << " bits, channel " << c;
        }
      }
    }
  }
}

// [ISO 61966-2-1] pinned: a level of 0.18 is sRGB code 118 (117.6), 1 is 255, and half a code rounds up.
TEST(Expose, PinnedCodes) {
  Image<float> light(5, 1, 3);
  const float levels[5] = {0.18f, 1.0f, 0.0f, 0.5f / 255 / 12.92f * 1.01f, 0.5f / 255 / 12.92f * 0.99f};
  for (int x = 0; x < 5; ++x) {
    for (int c = 0; c < 3; ++c) light(x, 0, c) = levels[x];
  }
  const Photo photo = expose(light, shutter(1), {srgb_response(8), kNoNoise, 1}, 1);
  const int expected[5] = {118, 255, 0, 1, 0};
  for (int x = 0; x < 5; ++x) EXPECT_EQ(code_at(photo, x, 0, 1), expected[x]) << "level " << levels[x];
}

TEST(Expose, ExposureMultipliesAndOverflowClips) {
  const Image<float> light = constant(2, 2, 0.02f);
  const Sensor sensor{linear_response(8), kNoNoise, 2};
  const Exposure exposure{.seconds = 4, .f_number = 2.0, .iso = 200.0};  // H = 4 * 2 / 4 = 2
  EXPECT_EQ(code_at(expose(light, exposure, sensor, 1), 0, 0, 0), std::lround(0.02 * 2 * 2 * 255));
  EXPECT_EQ(code_at(expose(light, shutter(1000), sensor, 1), 1, 1, 2), 255);
}

TEST(Expose, NanAndNegativeLightAreDark) {
  Image<float> light = constant(3, 1, 0.5f);
  light(0, 0, 0) = NAN;
  light(1, 0, 0) = -4;
  light(2, 0, 0) = INFINITY;
  const Photo photo = expose(light, shutter(1), {linear_response(8), kNoNoise, 1}, 1);
  EXPECT_EQ(code_at(photo, 0, 0, 0), 0);
  EXPECT_EQ(code_at(photo, 1, 0, 0), 0);
  EXPECT_EQ(code_at(photo, 2, 0, 0), 255);
}

// Var = (e + read^2) / full_well^2 of the level; 100000 samples know a standard deviation to 0.3 %.
TEST(Expose, NoiseHasTheVarianceOfTheModel) {
  const NoiseModel noise{2000, 12};
  const int codes = 65535;
  for (const float level : {0.05f, 0.5f}) {
    const Photo photo = expose(constant(200, 167, level), shutter(1), {linear_response(16), noise, 1}, 7);
    double sum = 0, squares = 0, count = 0, cross = 0;
    for (int y = 0; y < 167; ++y) {
      for (int x = 0; x < 200; ++x) {
        for (int c = 0; c < 3; ++c) {
          const double v = code_at(photo, x, y, c) / static_cast<double>(codes) - level;
          sum += v;
          squares += v * v;
          cross += v * (code_at(photo, x, y, (c + 1) % 3) / static_cast<double>(codes) - level);
          ++count;
        }
      }
    }
    const double expected = std::sqrt(level * 2000 + 144) / 2000;
    EXPECT_NEAR(std::sqrt(squares / count) / expected, 1, 0.015) << "level " << level;
    EXPECT_NEAR(sum / count, 0, 4 * expected / std::sqrt(count)) << "the noise has no bias";
    EXPECT_NEAR(cross / squares, 0, 0.02) << "channels are independent";
  }
}

TEST(Expose, NoiseDependsOnSeedAloneAndNotOnThreads) {
  const Image<float> scene = test::test_scene(64, 48, 8, 3);
  const Sensor sensor{film_response(8), {}, 0.1};
  const auto codes = [&](std::uint64_t seed) {
    const Photo photo = expose(scene, shutter(1), sensor, seed);
    std::vector<int> all;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) all.push_back(code_at(photo, x, y, 1));
    }
    return all;
  };
  set_threads(1);
  const auto one = codes(5);
  set_threads(2);
  EXPECT_EQ(codes(5), one);
  EXPECT_NE(codes(6), one);
  set_threads(0);
}

TEST(Shake, IdentityCopiesAndWholePixelsShift) {
  const Image<float> scene = test::test_scene(40, 30, 10, 2);
  const Image<float> same = shake(scene, Mat3::Identity());
  Mat3 shift = Mat3::Identity();
  shift(0, 2) = 3;
  shift(1, 2) = -2;
  const Image<float> moved = shake(scene, shift);
  for (int y = 2; y < 30; ++y) {
    for (int x = 0; x < 37; ++x) {
      ASSERT_EQ(same(x, y, 1), scene(x, y, 1));
      ASSERT_NEAR(moved(x, y, 1) / scene(x + 3, y - 2, 1), 1, 1e-5);
    }
  }
}

TEST(Shake, HalfAPixelIsTheGeometricMean) {
  Image<float> scene(2, 1, 3);
  for (int c = 0; c < 3; ++c) {
    scene(0, 0, c) = 1;
    scene(1, 0, c) = 100;
  }
  Mat3 half = Mat3::Identity();
  half(0, 2) = 0.5;
  const Image<float> moved = shake(scene, half);
  EXPECT_NEAR(moved(0, 0, 0), 10, 1e-4);
  EXPECT_NEAR(moved(1, 0, 0), 100, 1e-3) << "beyond the border the scene is mirrored";
}

}  // namespace
}  // namespace hdr
