// Blurs against their definitions, and the laws that they keep: constants, energy, symmetry, the sphere.
#include "libhdr/filter/blur.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

/// 1 with some texture, and a few pixels of 10^4: what HDR is about.
Image<float> scene_with_suns(int width, int height, std::uint64_t seed) {
  Image<float> scene = test::test_scene(width, height, 4, seed);
  Random random(seed, 9);
  for (int k = 0; k < 3; ++k) {
    const int x = static_cast<int>(random.uniform() * width), y = static_cast<int>(random.uniform() * height);
    for (int c = 0; c < 3; ++c) scene(x, y, c) = 1e4f;
  }
  return scene;
}

double sum_of(View<const float> image) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int k = 0; k < image.width() * image.channels(); ++k) sum += image.row(y)[k];
  }
  return sum;
}

int mirrored(int i, int n) {
  while (i < 0 || i >= n) i = i < 0 ? -1 - i : 2 * n - 1 - i;
  return i;
}

/// The sampled Gaussian, in double, every tap.
Image<float> exact_gaussian(View<const float> in, double sigma) {
  const int reach = static_cast<int>(std::ceil(7 * sigma));
  std::vector<double> weights;
  double total = 0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    total += weights.back();
  }
  const int w = in.width(), h = in.height(), channels = in.channels();
  std::vector<double> rows(static_cast<std::size_t>(w * h * channels));
  Image<float> out(in.size(), channels);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      for (int c = 0; c < channels; ++c) {
        double sum = 0;
        for (int k = -reach; k <= reach; ++k)
          sum += weights[static_cast<std::size_t>(k + reach)] * in(mirrored(x + k, w), y, c);
        rows[static_cast<std::size_t>((y * w + x) * channels + c)] = sum / total;
      }
    }
  }
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      for (int c = 0; c < channels; ++c) {
        double sum = 0;
        for (int k = -reach; k <= reach; ++k) {
          sum += weights[static_cast<std::size_t>(k + reach)] *
                 rows[static_cast<std::size_t>((mirrored(y + k, h) * w + x) * channels + c)];
        }
        out(x, y, c) = static_cast<float>(sum / total);
      }
    }
  }
  return out;
}

double worst_relative(View<const float> a, View<const float> b) {
  double worst = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int k = 0; k < a.width() * a.channels(); ++k) {
      worst = std::max(worst, std::abs(double{a.row(y)[k]} - b.row(y)[k]) / std::abs(double{b.row(y)[k]}));
    }
  }
  return worst;
}

TEST(Gaussian, IsTheExactOneEverywhereForAnySigma) {
  const Image<float> scene = scene_with_suns(150, 90, 3);
  for (const double sigma : {0.4, 1.0, 2.7, 3.9, 4.0, 6.3, 12.0, 25.0, 50.0, 140.0}) {
    EXPECT_LT(worst_relative(gaussian_blur(scene, sigma), exact_gaussian(scene, sigma)), 1e-4)
        << "sigma " << sigma << ": relative to each pixel, far from the suns too";
  }
}

TEST(Gaussian, KeepsConstantsAndLight) {
  Image<float> flat(61, 47, 2);
  for (int y = 0; y < 47; ++y) std::fill_n(flat.row(y), 122, 3.25f);
  for (const Surface surface : {Surface::kPlane, Surface::kLatLong}) {
    const Image<float> blurred = gaussian_blur(flat, 9, surface);
    EXPECT_LT(worst_relative(blurred, flat), 2e-6);
  }
  Image<float> sun(200, 120, 1);
  sun(3, 118) = 1e4f;
  for (const double sigma : {0.7, 3.0, 8.0, 50.0, 300.0}) {
    EXPECT_NEAR(sum_of(gaussian_blur(sun, sigma)), 1e4, 1)
        << "sigma " << sigma << ": in a corner, mirrored light comes back";
  }
  EXPECT_EQ(gaussian_blur(sun, 0)(3, 118), 1e4f);
  Image<float> one(1, 1, 3);
  one(0, 0, 1) = 5;
  EXPECT_NEAR(gaussian_blur(one, 20)(0, 0, 1), 5, 1e-5);
  EXPECT_THROW(gaussian_blur(one, -1), Error);
  EXPECT_THROW(gaussian_blur(one, std::nan("")), Error);
}

/// The kernel and the solid angles as the header has them, every pixel with every other.
Image<float> exact_on_sphere(View<const float> in, double sigma) {
  const int w = in.width(), h = in.height(), channels = in.channels();
  const double s = sigma * 2 * kPi / w;
  Image<float> out(in.size(), channels);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / w, (y + 0.5) / h);
      std::vector<double> sums(static_cast<std::size_t>(channels));
      double total = 0;
      for (int v = 0; v < h; ++v) {
        const double solid = std::cos(kPi * v / h) - std::cos(kPi * (v + 1) / h);
        for (int u = 0; u < w; ++u) {
          const double weight = solid * std::exp((d.dot(dir_from_latlong((u + 0.5) / w, (v + 0.5) / h)) - 1) / (s * s));
          total += weight;
          for (int c = 0; c < channels; ++c) sums[static_cast<std::size_t>(c)] += weight * in(u, v, c);
        }
      }
      for (int c = 0; c < channels; ++c) out(x, y, c) = static_cast<float>(sums[static_cast<std::size_t>(c)] / total);
    }
  }
  return out;
}

double energy(View<const float> latlong) {
  double sum = 0;
  for (int y = 0; y < latlong.height(); ++y) {
    const double solid = std::cos(kPi * y / latlong.height()) - std::cos(kPi * (y + 1) / latlong.height());
    for (int k = 0; k < latlong.width() * latlong.channels(); ++k) sum += solid * latlong.row(y)[k];
  }
  return sum;
}

TEST(SphereGaussian, IsTheSumOverAllDirections) {
  for (const int width : {60, 45}) {
    const Image<float> scene = scene_with_suns(width, 30, 5);
    for (const double sigma : {1.0, 2.0, 5.0, 20.0, 100.0}) {
      EXPECT_LT(worst_relative(gaussian_blur(scene, sigma, Surface::kLatLong), exact_on_sphere(scene, sigma)), 1e-3)
          << width << " wide, sigma " << sigma;
    }
  }
}

TEST(SphereGaussian, KeepsTheEnergyOfASunAnywhere) {
  for (const int y : {0, 1, 7, 64, 100, 127}) {
    Image<float> sky(256, 128, 1);
    for (int row = 0; row < 128; ++row) std::fill_n(sky.row(row), 256, 0.5f);
    sky(255, y) = 1e4f;
    for (const double sigma : {1.0, 3.0, 12.0}) {
      const Image<float> blurred = gaussian_blur(sky, sigma, Surface::kLatLong);
      EXPECT_NEAR(energy(blurred) / energy(sky), 1, 1e-3) << "row " << y << ", sigma " << sigma;
      EXPECT_NEAR(blurred(0, y) / blurred(254, y), 1, 1e-4) << "the seam is no border";
    }
  }
}

/// The integral, by many thin steps.
double exact_motion(View<const float> in, int x, int y, int c, double length, double degrees) {
  constexpr int kSamples = 200000;
  double sum = 0;
  for (int k = 0; k < kSamples; ++k) {
    const double t = ((k + 0.5) / kSamples - 0.5) * length;
    const int u = static_cast<int>(std::floor(x + 0.5 + t * std::cos(degrees * kDegree)));
    const int v = static_cast<int>(std::floor(y + 0.5 - t * std::sin(degrees * kDegree)));
    sum += in(mirrored(u, in.width()), mirrored(v, in.height()), c);
  }
  return sum / kSamples;
}

TEST(Motion, IsTheIntegralAlongTheLine) {
  const Image<float> scene = test::test_scene(70, 50, 6, 11);
  for (const double length : {0.3, 1.0, 4.5, 17.25, 160.0}) {
    for (const double degrees : {0.0, 90.0, 30.0, 44.0, -62.5, 180.0}) {
      const Image<float> blurred = motion_blur(scene, length, degrees);
      for (const auto& [x, y] : {std::pair{35, 25}, {0, 0}, {69, 12}, {20, 49}}) {
        const double truth = exact_motion(scene, x, y, 1, length, degrees);
        EXPECT_NEAR(blurred(x, y, 1) / truth, 1, 5e-4) << length << "@" << degrees << " at " << x << "," << y;
      }
    }
  }
}

TEST(Motion, GoesTheWayTheAngleSaysAndKeepsLight) {
  Image<float> sun(41, 41, 3);
  for (int c = 0; c < 3; ++c) sun(20, 20, c) = 1e4f;
  const Image<float> up_right = motion_blur(sun, 20, 45);
  EXPECT_GT(up_right(25, 15, 0), 100) << "45 degrees: right and up, y down";
  EXPECT_EQ(up_right(25, 25, 0), 0);
  for (const double degrees : {0.0, 90.0, 45.0, 10.0}) {
    EXPECT_NEAR(sum_of(motion_blur(sun, 12.7, degrees)), 3e4, 0.3) << degrees;
  }
  Image<float> corner(41, 41, 1);
  corner(0, 40) = 1e4f;
  EXPECT_NEAR(sum_of(motion_blur(corner, 31, 0)), 1e4, 1) << "mirrored at the border, nothing is lost";
  EXPECT_EQ(motion_blur(sun, 0, 33)(20, 20, 1), 1e4f);
  EXPECT_THROW(motion_blur(sun, -1, 0), Error);
}

TEST(Motion, OnTheSphereTheSeamIsNoBorderAndAPoleIsPassed) {
  Image<float> map(32, 16, 1);
  map(0, 8) = 100;
  const Image<float> turned = motion_blur(map, 5, 0, Surface::kLatLong);
  for (const int x : {30, 31, 0, 1, 2}) EXPECT_FLOAT_EQ(turned(x, 8), 20) << x;
  EXPECT_EQ(turned(3, 8), 0);
  EXPECT_EQ(turned(15, 8), 0);
  Image<float> top(32, 16, 1);
  top(3, 0) = 100;
  const Image<float> over = motion_blur(top, 3, 90, Surface::kLatLong);
  EXPECT_NEAR(over(3, 0), 100 / 3.0, 1e-3);
  EXPECT_NEAR(over(3, 1), 100 / 3.0, 1e-3);
  EXPECT_NEAR(over(19, 0), 100 / 3.0, 1e-3) << "beyond the pole lies the opposite meridian";
}

// A running sum that rounds would leave 1e-4 of such a sun behind in all that follows it.
TEST(Motion, ASunLeavesNothingBehind) {
  Image<float> map(400, 1, 1);
  for (int x = 0; x < 400; ++x) map(x, 0) = 1e-9f;
  map(20, 0) = 1e12f;
  for (const Surface surface : {Surface::kPlane, Surface::kLatLong}) {
    const Image<float> moved = motion_blur(map, 9, 0, surface);
    for (int x = 40; x < 380; ++x) EXPECT_NEAR(moved(x, 0), 1e-9, 1e-15) << x;
  }
}

TEST(Gaussian, AnySigmaGivesAMean) {
  const Image<float> scene = scene_with_suns(48, 24, 5);
  for (const double sigma : {1e-300, 1e-6, 120.0, 1e5, 1e9, 1e300}) {
    for (const Surface surface : {Surface::kPlane, Surface::kLatLong}) {
      const Image<float> blurred = gaussian_blur(scene, sigma, surface);
      for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 48; ++x) {
          ASSERT_GT(blurred(x, y), 0) << sigma;
          ASSERT_LE(blurred(x, y), 1.0001e4f) << sigma;
        }
      }
    }
  }
  const Image<float> flat = gaussian_blur(scene, 1e9);
  EXPECT_NEAR(flat(0, 0), flat(47, 23), 1e-4 * flat(0, 0)) << "the mean of all";
}

}  // namespace
}  // namespace hdr
