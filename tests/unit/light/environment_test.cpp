// A sampler, its density and its inverse must tell one story.
#include "libhdr/light/environment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/color.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

using test::constant_map;
using test::lobes_map;

// Random maps with black pixels, black rows and a range of 1e6.
Image<float> rough_map(Size size, std::uint64_t seed) {
  Random random(seed, 3);
  Image<float> map(size, 3);
  for (int y = 0; y < size.height; ++y) {
    if (size.height > 2 && y == size.height / 2) continue;
    for (int x = 0; x < size.width; ++x) {
      if (random.uniform() < 0.2) continue;
      for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(std::exp(14 * random.uniform()));
    }
  }
  return map;
}

// Integral of the density over the sphere: each pixel's density at its middle times its exact solid angle.
double integral_of_pdf(const Environment& light) {
  double sum = 0;
  const int width = light.latlong().width(), height = light.latlong().height();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      sum += light.pdf(dir_from_latlong((x + 0.5) / width, (y + 0.5) / height).cast<float>()) *
             latlong_pixel_solid_angle(y, width, height);
  return sum;
}

TEST(Environment, DensityIntegratesToOne) {
  for (const Size size : {Size{1, 1}, Size{2, 1}, Size{5, 3}, Size{64, 32}}) {
    EXPECT_NEAR(integral_of_pdf(Environment(rough_map(size, 8))), 1, 1e-6);
    EXPECT_NEAR(integral_of_pdf(Environment(constant_map(size, Rgbf::Zero()))), 1, 1e-6) << "black";
    const auto compensated = Environment::Density::kCompensated;
    EXPECT_NEAR(integral_of_pdf(Environment(rough_map(size, 8), compensated)), 1, 1e-6) << "compensated";
    EXPECT_NEAR(integral_of_pdf(Environment(constant_map(size, Rgbf::Ones()), compensated)), 1, 1e-6) << "grey";
  }
}

// Chi-square over sub-cells: each pixel is split in 2x2 equal solid angles, so that uniformity inside is tested too.
void expect_samples_follow_density(const Environment& light) {
  const Size size = light.latlong().size();
  const int columns = 2 * size.width, bands = 2 * size.height;
  std::vector<double> observed(static_cast<std::size_t>(columns * bands));
  Random random(4, 0);
  constexpr int kSamples = 400000;
  for (int i = 0; i < kSamples; ++i) {
    const double u = random.uniform(), v = random.uniform();
    const Vec3 d = light.sample({u, v}).dir.cast<double>();
    const Vec2 uv = latlong_from_dir(d);
    const int x = static_cast<int>(uv.x() * columns);
    const int row = std::min(size.height - 1, static_cast<int>(uv.y() * size.height));
    const double c0 = std::cos(kPi * row / size.height), c1 = std::cos(kPi * (row + 1) / size.height);
    const int y = 2 * row + ((c0 - d.y()) / (c0 - c1) > 0.5);
    observed[static_cast<std::size_t>(y * columns + x)]++;
  }
  double chi2 = 0;
  int cells = 0;
  for (int y = 0; y < bands; ++y) {
    for (int x = 0; x < columns; ++x) {
      const double pdf = light.pdf(dir_from_latlong((x + 0.5) / columns, (y / 2 + 0.5) / size.height).cast<float>());
      const double expected = kSamples * pdf * latlong_pixel_solid_angle(y / 2, size.width, size.height) / 4;
      const double seen = observed[static_cast<std::size_t>(y * columns + x)];
      EXPECT_TRUE(pdf > 0 || seen == 0) << "a black pixel was drawn";
      if (expected < 5) continue;
      chi2 += (seen - expected) * (seen - expected) / expected;
      ++cells;
    }
  }
  ASSERT_GT(cells, 50);
  // Normal approximation of chi-square: 4 sigma.
  EXPECT_LT(chi2, cells + 4 * std::sqrt(2.0 * cells)) << cells << " cells";
}

TEST(Environment, SamplesOfAliasTablesFollowTheirDensity) {
  constexpr auto kAlias = Environment::Order::kAlias;
  for (const auto density : {Environment::Density::kLuminance, Environment::Density::kCompensated}) {
    expect_samples_follow_density(Environment(rough_map({100, 6}, 23), density, kAlias));
    expect_samples_follow_density(Environment(lobes_map({64, 8}, 2, 5, 21), density, kAlias));
  }
  expect_samples_follow_density(
      Environment(constant_map({34, 7}, Rgbf::Zero()), Environment::Density::kLuminance, kAlias));
}

TEST(Environment, SamplesFollowTheirDensity) {
  expect_samples_follow_density(Environment(rough_map({100, 6}, 23)));
  expect_samples_follow_density(Environment(rough_map({12, 6}, 21)));
  expect_samples_follow_density(Environment(lobes_map({16, 8}, 2, 5, 21)));
  expect_samples_follow_density(Environment(constant_map({14, 7}, Rgbf::Zero())));
}

TEST(Environment, CompensatedSamplesFollowTheirDensity) {
  expect_samples_follow_density(Environment(rough_map({24, 12}, 22), Environment::Density::kCompensated));
  expect_samples_follow_density(Environment(lobes_map({24, 12}, 3, 10, 5), Environment::Density::kCompensated));
}

TEST(Environment, CompensationLeavesThePixelsBelowTheMeanToOthers) {
  const Environment light(lobes_map({64, 32}, 2, 50, 3), Environment::Density::kCompensated);
  const Rgb power = light.total_power();
  const double mean = luminance(power[0], power[1], power[2]) / (4 * kPi);
  Random random(6, 0);
  for (int i = 0; i < 2000; ++i) {
    const Environment::Sample s = light.lookup(test::random_dir(random).cast<float>());
    EXPECT_EQ(s.pdf > 0, luminance<double>(s.radiance[0], s.radiance[1], s.radiance[2]) > mean);
    EXPECT_GT(light.sample({random.uniform(), random.uniform()}).pdf, 0);
  }
}

// A map of 1e30, as a hostile file may hold: sums neither overflow nor vanish.
TEST(Environment, HugeAndTinyMapsKeepTheirShares) {
  for (const float scale : {1e-30f, 1e30f}) {
    Image<float> map = rough_map({16, 8}, 2);
    const Environment plain(map.clone());
    for (int y = 0; y < 8; ++y)
      for (int k = 0; k < 48; ++k) map.row(y)[k] *= scale;
    const Environment light(std::move(map));
    Random random(2, 2);
    for (int i = 0; i < 100; ++i) {
      const Vec2 u(random.uniform(), random.uniform());
      EXPECT_LT((light.sample(u).dir - plain.sample(u).dir).norm(), 1e-4);
      EXPECT_NEAR(light.sample(u).pdf / plain.sample(u).pdf, 1, 1e-4);
    }
  }
}

TEST(Environment, SampleCarriesRadianceAndDensityOfItsPixel) {
  const Environment light(rough_map({16, 8}, 2));
  Random random(9, 0);
  for (int i = 0; i < 1000; ++i) {
    const Environment::Sample s = light.sample({random.uniform(), random.uniform()});
    EXPECT_NEAR(s.dir.norm(), 1, 1e-6);
    // One channel's ratio to the density is luminance / pdf = total, for every sample.
    const double total = luminance<double>(s.radiance[0], s.radiance[1], s.radiance[2]) / s.pdf;
    const Rgb power = light.total_power();
    EXPECT_NEAR(total / luminance(power[0], power[1], power[2]), 1, 1e-5);
  }
}

TEST(Environment, ManySamplesAtOnceAreTheSamplesOneByOne) {
  for (const auto order : {Environment::Order::kInOrder, Environment::Order::kAlias}) {
    for (const bool black : {false, true}) {
      const Environment light(black ? constant_map({40, 20}, Rgbf::Zero()) : rough_map({40, 20}, 7),
                              Environment::Density::kLuminance, order);
      Random random(14, 0);
      std::vector<Vec2> u(1003);  // no multiple of what is done at once
      for (Vec2& v : u) v = {random.uniform(), random.uniform()};
      std::vector<Environment::Sample> samples(u.size());
      light.sample(u, samples);
      for (std::size_t k = 0; k < u.size(); ++k) {
        const Environment::Sample one = light.sample(u[k]);
        EXPECT_EQ(samples[k].dir, one.dir) << k;
        EXPECT_EQ(samples[k].pdf, one.pdf) << k;
        EXPECT_TRUE((samples[k].radiance == one.radiance).all()) << k;
      }
    }
  }
}

// Stratified numbers stay stratified: along either number, samples move one way only.
TEST(Environment, SamplesMoveOneWayWithTheirNumbers) {
  const Environment light(rough_map({300, 150}, 11));
  for (const double fixed : {0.1, 0.45, 0.93}) {
    double across = -1, down = -1;
    for (int k = 0; k < 4000; ++k) {
      const double moving = (k + 0.5) / 4000;
      const Vec2 right = latlong_from_dir(light.sample({moving, fixed}).dir.cast<double>());
      const Vec2 below = latlong_from_dir(light.sample({fixed, moving}).dir.cast<double>());
      EXPECT_GE(right.x(), across - 1e-6) << moving;
      EXPECT_GE(below.y(), down - 1e-6) << moving;
      across = right.x();
      down = below.y();
    }
  }
}

TEST(Environment, InvertUndoesSample) {
  for (const Size size : {Size{1, 1}, Size{2, 1}, Size{9, 4}, Size{64, 32}, Size{100, 50}}) {
    for (const int kind : {0, 1, 2, 3}) {
      const Environment light(kind & 1 ? constant_map(size, Rgbf::Zero()) : rough_map(size, 5),
                              Environment::Density::kLuminance,
                              kind & 2 ? Environment::Order::kAlias : Environment::Order::kInOrder);
      Random random(10, 0);
      for (int i = 0; i < 500; ++i) {
        const Vec2 u(random.uniform(), random.uniform());
        const Environment::Sample s = light.sample(u);
        const Environment::Sample again = light.sample(light.invert(s.dir));
        EXPECT_LT((again.dir - s.dir).norm(), 2e-6)
            << size.width << "x" << size.height << " u " << u.transpose() << " -> " << s.dir.transpose() << " -> "
            << light.invert(s.dir).transpose() << " -> " << again.dir.transpose();
      }
    }
  }
}

TEST(Environment, InvertRecoversTheNumbersWhereTheDensityIsSmooth) {
  const Environment light(lobes_map({64, 32}, 3, 4, 1));
  Random random(12, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 u(random.uniform(), random.uniform());
    // The direction is float: 1e-7 radians. Beside a pole that is a large share of the azimuth.
    const Vec3f dir = light.sample(u).dir;
    if (std::abs(dir.y()) > 0.99f) continue;
    EXPECT_LT((light.invert(dir) - u).norm(), 1e-4) << u.transpose();
  }
}

TEST(Environment, ASunOfOnePixelTakesItsShare) {
  Image<float> map = constant_map({1024, 512}, Rgbf::Constant(1));
  for (int c = 0; c < 3; ++c) map(100, 200, c) = 1e6f;
  const double omega = latlong_pixel_solid_angle(200, 1024, 512);
  const double share = 1e6 * omega / (4 * kPi + (1e6 - 1) * omega);
  const Environment light(std::move(map));
  Random random(13, 0);
  int hits = 0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) hits += light.sample({random.uniform(), random.uniform()}).radiance[0] > 1;
  EXPECT_NEAR(hits, kSamples * share, 4 * std::sqrt(kSamples * share * (1 - share)));
}

TEST(Environment, PolesAndSeamHaveAPixel) {
  Image<float> map(4, 2, 3);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(1 + 4 * y + x);
  const Environment light(std::move(map));
  EXPECT_EQ(light.radiance({0, 1, 0})[0], 3) << "the pole is u = 1/2: the third column";
  EXPECT_EQ(light.radiance({0, -1, 0})[0], 7);
  // The seam is -Z; +X is left of the centre, so the last column lies on the side of -X.
  EXPECT_EQ(light.radiance(Vec3f(1e-3f, 0.1f, -1).normalized())[0], 1);
  EXPECT_EQ(light.radiance(Vec3f(-1e-3f, 0.1f, -1).normalized())[0], 4);
  EXPECT_EQ(light.radiance(Vec3f(-1e-9f, -0.1f, -1).normalized())[0] - 4,
            light.radiance(Vec3f(-1e-9f, 0.1f, -1).normalized())[0]);
  for (const Vec3f& d : {Vec3f(0, 1, 0), Vec3f(0, -1, 0), Vec3f(0, 0, -1)}) EXPECT_GT(light.pdf(d), 0);
}

TEST(Environment, TheEndsOfTheUnitSquareNeverMeetBlackPixels) {
  Image<float> map(5, 5, 3);
  map(2, 2, 1) = 3;
  const Environment light(std::move(map));
  constexpr double kLast = 1 - 0x1p-53;
  for (const double u : {0.0, kLast})
    for (const double v : {0.0, kLast}) EXPECT_EQ(light.sample({u, v}).radiance[1], 3) << u << ' ' << v;
}

TEST(Environment, TotalPowerIsTheIntegral) {
  const Environment light(constant_map({7, 3}, Rgbf(1, 2, 3)));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(light.total_power()[c], 4 * kPi * (c + 1), 1e-9);
}

TEST(Environment, FromAnAngularMapKeepsThePower) {
  constexpr int kWidth = 128;
  RadianceMap probe;
  probe.rgb = constant_map({kWidth, kWidth}, Rgbf(2, 2, 2));
  const Environment light = Environment::from_probe(probe, AngularMap{inscribed_disc(kWidth)});
  EXPECT_EQ(light.latlong().width(), kWidth) << "2 pi radians at pi / 64 a pixel";
  EXPECT_NEAR(light.total_power()[0], 8 * kPi, 0.02 * 8 * kPi);
}

}  // namespace
}  // namespace hdr
