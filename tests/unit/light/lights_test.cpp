// A probe as lights: nothing is lost, regions are regions of the sphere, and irradiance is kept.
#include "libhdr/light/lights.h"

#include <gtest/gtest.h>

#include <set>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/light/internal/components.h"
#include "libhdr/light/internal/light_cells.h"
#include "libhdr/light/lights_text.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

constexpr LightsMethod kMethods[] = {LightsMethod::kMedianCut, LightsMethod::kVarianceCut, LightsMethod::kStructured,
                                     LightsMethod::kKolligKeller};
constexpr LightPlacement kPlacements[] = {LightPlacement::kCentroid, LightPlacement::kMatched,
                                          LightPlacement::kJittered};

// Lobes, and on some a sun of one pixel.
Image<float> world(std::uint64_t seed, Size size = {64, 32}) {
  Image<float> map = test::lobes_map(size, 1 + static_cast<int>(seed % 6), 200, seed);
  Random random(seed, 9);
  if (seed % 2 == 1) {
    const int x = static_cast<int>(random.uniform() * size.width), y = static_cast<int>(random.uniform() * size.height);
    for (int c = 0; c < 3; ++c) map(x, y, c) = 1e4f;
  }
  return map;
}

Rgb flux_of(View<const float> map) {
  return project(map, LatLong{map.size()}, 0)(0, 0) * std::sqrt(4 * kPi);
}

TEST(Lights, KeepAllLightAndTheWholeSphere) {
  for (const LightsMethod method : kMethods) {
    for (const LightPlacement placement : kPlacements) {
      for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const Image<float> map = world(seed);
        const int count = 1 + static_cast<int>(seed * seed * 3);
        const Lights lights = make_lights(map, {count, method, placement, seed});
        ASSERT_EQ(static_cast<int>(lights.lights.size()), count);
        Rgb sum = Rgb::Zero();
        double sphere = 0, before = 1e300;
        for (const DirectionalLight& light : lights.lights) {
          EXPECT_NEAR(light.direction.norm(), 1, 1e-9);
          EXPECT_GE(light.irradiance.minCoeff(), 0);
          const double brightness = luminance(light.irradiance[0], light.irradiance[1], light.irradiance[2]);
          EXPECT_LE(brightness, before * (1 + 1e-12)) << "brightest first";
          before = brightness;
          sum += light.irradiance;
          sphere += light.solid_angle;
        }
        EXPECT_LT((sum / flux_of(map) - 1).abs().maxCoeff(), 1e-9);
        EXPECT_NEAR(sphere, 4 * kPi, 1e-9);
        std::set<std::int32_t> labels;
        for (int y = 0; y < lights.strata.height(); ++y)
          for (int x = 0; x < lights.strata.width(); ++x) labels.insert(lights.strata(x, y));
        EXPECT_EQ(static_cast<int>(labels.size()), count);
        EXPECT_EQ(*labels.begin(), 0);
      }
    }
  }
}

TEST(Lights, CentroidsLieWhereTheLightOfTheRegionIs) {
  Image<float> map = test::constant_map({64, 32}, Rgbf::Constant(0.01f));
  const Vec3 sun = dir_from_latlong(40.5 / 64, 8.5 / 32);
  for (int c = 0; c < 3; ++c) map(40, 8, c) = 1e6f;
  for (const LightsMethod method : kMethods) {
    for (const int count : {1, 2, 7, 32}) {
      const Lights lights = make_lights(map, {count, method, std::nullopt, 1});
      EXPECT_LT((lights.lights[0].direction - sun).norm(), 0.01) << static_cast<int>(method) << " with " << count;
    }
  }
}

TEST(Lights, MapsThatHoldNothingOrLittle) {
  for (const LightsMethod method : kMethods) {
    const Image<float> black = test::constant_map({16, 8}, Rgbf::Zero());
    EXPECT_EQ(make_lights(black, {5, method, std::nullopt, 1}).lights.size(), 5u);
    for (const DirectionalLight& light : make_lights(black, {5, method, std::nullopt, 1}).lights) {
      EXPECT_NEAR(light.direction.norm(), 1, 1e-9);
      EXPECT_EQ(light.irradiance.maxCoeff(), 0);
    }
    const Image<float> grey = test::constant_map({32, 16}, Rgbf::Constant(2));
    EXPECT_EQ(make_lights(grey, {40, method, std::nullopt, 1}).lights.size(), 40u);
    const Image<float> one = test::constant_map({1, 1}, Rgbf::Constant(2));
    EXPECT_EQ(make_lights(one, {3, method, std::nullopt, 1}).lights.size(), 1u);
    const Image<float> two = test::constant_map({2, 1}, Rgbf::Constant(2));
    EXPECT_EQ(make_lights(two, {3, method, std::nullopt, 1}).lights.size(), 2u);
    Image<float> speck = test::constant_map({32, 16}, Rgbf::Zero());
    speck(3, 3, 0) = 1e30f;
    for (const DirectionalLight& light : make_lights(speck, {9, method, std::nullopt, 1}).lights) {
      EXPECT_TRUE(light.irradiance.isFinite().all());
      EXPECT_TRUE(light.direction.allFinite());
    }
    EXPECT_THROW(make_lights(grey, {0, method, std::nullopt, 1}), Error);
  }
}

TEST(Lights, ManyLightsHaveTheIrradianceOfTheMap) {
  for (const LightsMethod method : kMethods) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const Image<float> map = world(seed, {128, 64});
      const double few = irradiance_rms_error(make_lights(map, {16, method, std::nullopt, 1}).lights, map);
      const double many = irradiance_rms_error(make_lights(map, {200, method, std::nullopt, 1}).lights, map);
      EXPECT_LT(few, method == LightsMethod::kMedianCut ? 0.10 : 0.04) << static_cast<int>(method) << " seed " << seed;
      EXPECT_LT(many, 0.006) << static_cast<int>(method) << " seed " << seed;
    }
  }
}

TEST(Lights, MatchingMakesIrradianceBetterAndMovesNoLightFar) {
  for (const LightsMethod method : kMethods) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const Image<float> map = world(seed, {128, 64});
      const Lights plain = make_lights(map, {32, method, LightPlacement::kCentroid, 1});
      const Lights matched = make_lights(map, {32, method, LightPlacement::kMatched, 1});
      EXPECT_LE(irradiance_rms_error(matched.lights, map), irradiance_rms_error(plain.lights, map))
          << static_cast<int>(method) << " seed " << seed;
      for (std::size_t k = 0; k < plain.lights.size(); ++k) {
        EXPECT_TRUE((plain.lights[k].irradiance == matched.lights[k].irradiance).all());
        EXPECT_GT(plain.lights[k].direction.dot(matched.lights[k].direction), 0) << "of the same region";
      }
    }
  }
}

TEST(Lights, MedianCutHalvesTheLightVarianceCutTheVariance) {
  const Image<float> map = test::lobes_map({256, 128}, 5, 20, 4);
  const Lights lights = make_lights(map, {8, LightsMethod::kMedianCut, std::nullopt, 1});
  for (const DirectionalLight& light : lights.lights) {
    const Rgb share = 8 * light.irradiance / flux_of(map);
    EXPECT_NEAR(luminance(share[0], share[1], share[2]), 1, 0.1) << "three halvings: an eighth each";
  }
  // The variance that is left falls with every cut.
  const LightCells cells = light_cells(map, 256);
  double before = 1e300;
  for (const int count : {1, 2, 4, 8, 16, 64}) {
    const Partition labels = cut_by_variance(cells, count);
    std::vector<double> light(static_cast<std::size_t>(count));
    std::vector<Vec3> moment(light.size(), Vec3::Zero());
    for (std::size_t k = 0; k < labels.size(); ++k) {
      light[static_cast<std::size_t>(labels[k])] += cells.cells[k].luminance;
      moment[static_cast<std::size_t>(labels[k])] += cells.cells[k].moment;
    }
    double variance = 0;
    for (std::size_t k = 0; k < light.size(); ++k) variance += light[k] - moment[k].squaredNorm() / light[k];
    EXPECT_LT(variance, before);
    before = variance;
  }
}

// The paper's point: L dw^(1/4) gives a small sun some samples, not nearly all (as pure light would), and dim regions
// theirs; and strata do not cross levels.
TEST(Lights, StructuredGivesASunItsShareByTheMetric) {
  Image<float> map = test::constant_map({128, 64}, Rgbf::Constant(1));
  for (int y = 15; y < 19; ++y)
    for (int x = 30; x < 34; ++x)
      for (int c = 0; c < 3; ++c) map(x, y, c) = 2000;
  const Lights lights = make_lights(map, {100, LightsMethod::kStructured, LightPlacement::kCentroid, 1});
  std::set<std::int32_t> in_sun;
  double solid_angle = 0;
  for (int y = 15; y < 19; ++y) {
    for (int x = 30; x < 34; ++x) in_sun.insert(lights.strata(x, y));
    solid_angle += 4 * latlong_pixel_solid_angle(y, 128, 64);
  }
  const double sun = 2000 * solid_angle * std::pow(std::min(solid_angle, 0.01) / 0.01, 0.25),
               sky = 4 * kPi - solid_angle;
  EXPECT_NEAR(static_cast<double>(in_sun.size()), std::min(16.0, 100 * sun / (sun + sky)), 1.01);
  for (const std::int32_t label : in_sun) {
    EXPECT_LE(lights.lights[static_cast<std::size_t>(label)].solid_angle, solid_angle * (1 + 1e-9))
        << "a stratum reaches from the sun into the sky";
  }
}

TEST(Lights, FarthestPointStrataOfAGreySkyAreOfOneSize) {
  const Image<float> grey = test::constant_map({128, 64}, Rgbf::Constant(1));
  const Lights lights = make_lights(grey, {50, LightsMethod::kStructured, LightPlacement::kCentroid, 1});
  for (const DirectionalLight& light : lights.lights) {
    EXPECT_GT(light.solid_angle, 0.3 * 4 * kPi / 50);
    EXPECT_LT(light.solid_angle, 3 * 4 * kPi / 50);
  }
}

TEST(Lights, SameForAnyNumberOfThreads) {
  const Image<float> map = world(3, {128, 64});
  for (const LightsMethod method : kMethods) {
    set_threads(1);
    const Lights one = make_lights(map, {40, method, std::nullopt, 1});
    set_threads(2);
    const Lights two = make_lights(map, {40, method, std::nullopt, 1});
    set_threads(0);
    for (std::size_t k = 0; k < one.lights.size(); ++k) {
      EXPECT_EQ(one.lights[k].direction, two.lights[k].direction);
      EXPECT_TRUE((one.lights[k].irradiance == two.lights[k].irradiance).all());
    }
  }
}

TEST(Lights, EveryPixelAsALightIsTheIntegral) {
  const Image<float> map = world(5, {96, 48});
  const std::vector<DirectionalLight> lights = pixel_lights(map);
  Random random(3, 0);
  for (int k = 0; k < 20; ++k) {
    const Vec3 n = test::random_dir(random);
    const Rgb e = irradiance(lights, n), expected = test::brute_force_irradiance(map, n);
    EXPECT_LT((e / expected - 1).abs().maxCoeff(), 1e-12);
  }
}

TEST(Components, TheSphereHasNoSeamAndNoPoles) {
  const Size size{8, 4};
  std::vector<std::uint8_t> inside(32, 0);
  inside[8] = inside[15] = 1;  // both ends of the second row
  EXPECT_EQ(connected_components(inside, size).size(), 1u) << "across the seam";
  inside.assign(32, 0);
  inside[1] = inside[5] = 1;  // opposite cells of the first row
  EXPECT_EQ(connected_components(inside, size).size(), 1u) << "around the pole";
  inside.assign(32, 0);
  inside[9] = inside[13] = 1;
  EXPECT_EQ(connected_components(inside, size).size(), 2u);
  inside.assign(32, 0);
  inside[9] = inside[18] = 1;
  EXPECT_EQ(connected_components(inside, size).size(), 1u) << "corners touch";
  inside.assign(32, 1);
  EXPECT_EQ(connected_components(inside, size)[0].size(), 32u);
}

TEST(LightsText, UsdAndRadianceCarryTheNumbers) {
  const std::vector<DirectionalLight> lights{{Vec3(0, 1, 0), Rgb(2, 4, 1), 0.1}, {Vec3(0, 0, 1), Rgb(0, 0, 0), 0.1}};
  const std::string usd = usd_of(lights);
  EXPECT_EQ(usd.rfind("#usda 1.0", 0), 0u);
  EXPECT_NE(usd.find("inputs:intensity = 4\n"), std::string::npos);
  EXPECT_NE(usd.find("inputs:color = (0.5, 1, 0.25)"), std::string::npos);
  EXPECT_NE(usd.find("(0, 1, 0, 0), (0, 0, 0, 1) )"), std::string::npos) << "the third row is the direction";
  const std::string rad = rad_of(lights);
  EXPECT_NE(rad.find("0 -0 1 0.53"), std::string::npos) << "+Y of the probe is up, +Z, in Radiance\n" << rad;
  EXPECT_EQ(rad.find("probe_1"), std::string::npos) << "a black light is none";
}

}  // namespace
}  // namespace hdr
