// What the fast ways share with the slow ones.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/allotment.h"
#include "libhdr/render/internal/latlong_lookup.h"
#include "libhdr/render/internal/light_strata.h"
#include "libhdr/render/tracer.h"

namespace hdr {
namespace {

Vec3f random_dir(Random& random) {
  const double z = 2 * random.uniform() - 1, azimuth = 2 * kPi * random.uniform(), s = std::sqrt(1 - z * z);
  return Vec3f(Vec3(s * std::cos(azimuth), s * std::sin(azimuth), z).cast<float>());
}

TEST(Packets, TellWhatSingleRaysTell) {
  const Scene scene = spheres_on_plane();
  const Tracer tracer(scene);
  Random random(1, 1);
  constexpr std::size_t kRays = 16 * 64;
  std::vector<float> arrays[6];
  std::vector<Vec3f> origins, dirs;
  std::vector<std::int32_t> wanted;
  for (std::size_t k = 0; k < kRays; ++k) {
    origins.push_back(Vec3f(0, 1.5f, 0) + 3 * random_dir(random));
    dirs.push_back(random_dir(random));
    // Some packets are full, some have a few rays, some none.
    wanted.push_back(k / 16 % 3 == 0 ? -1 : k / 16 % 3 == 1 && random.uniform() < 0.3 ? -1 : 0);
    for (std::size_t i = 0; i < 3; ++i) {
      arrays[i].push_back(origins.back()[static_cast<int>(i)]);
      arrays[3 + i].push_back(dirs.back()[static_cast<int>(i)]);
    }
  }
  const RayArrays rays{arrays[0].data(), arrays[1].data(), arrays[2].data(),
                       arrays[3].data(), arrays[4].data(), arrays[5].data()};
  std::vector<std::int32_t> visible = wanted;
  int expected_traced = 0, differing = 0, blocked = 0;
  const int traced = tracer.visible(rays, visible);
  std::vector<std::int32_t> visible_to_a_beam = wanted;
  EXPECT_EQ(tracer.visible(rays, visible_to_a_beam, Spread::kBeam), traced);
  std::vector<std::optional<Hit>> hits(kRays - 5);
  tracer.intersect(rays, hits);
  for (std::size_t k = 0; k < kRays; ++k) {
    expected_traced += wanted[k] != 0;
    const bool occluded = tracer.occluded(origins[k], dirs[k]);
    if (wanted[k] != 0) differing += (visible[k] != 0) == occluded;
    differing += visible[k] != visible_to_a_beam[k];
    blocked += wanted[k] != 0 && occluded;
    if (wanted[k] == 0) {
      EXPECT_EQ(visible[k], 0) << "a ray that nobody asked for";
    }
    if (k >= hits.size()) continue;
    const std::optional<Hit> hit = tracer.intersect(origins[k], dirs[k]);
    if (hit.has_value() != hits[k].has_value()) {
      ++differing;
    } else if (hit) {
      EXPECT_LT((hit->position - hits[k]->position).norm(), 1e-4f);
    }
  }
  EXPECT_EQ(traced, expected_traced);
  EXPECT_GT(blocked, 50);
  EXPECT_LE(differing, 1) << "a ray that grazes an edge may be rounded otherwise";
}

TEST(LatLongLookup, MeetsThePixelsOfTheExactFormula) {
  Image<float> map(1000, 500, 3);
  Random random(2, 2);
  std::vector<float> x, y, z;
  std::vector<Vec3f> dirs;
  for (int k = 0; k < 4096; ++k) {
    Vec3f d = random_dir(random);
    if (k % 8 == 0) d = Vec3f(1e-3f * d.x(), k % 16 ? 1.0f : -1.0f, 1e-3f * d.z());  // about the poles
    dirs.push_back(2.5f * d);
    x.push_back(dirs.back().x());
    y.push_back(dirs.back().y());
    z.push_back(dirs.back().z());
  }
  std::vector<std::int32_t> offsets(dirs.size());
  latlong_offsets(x.data(), y.data(), z.data(), static_cast<int>(dirs.size()), map, offsets.data());
  int differing = 0;
  for (std::size_t k = 0; k < dirs.size(); ++k) {
    const Vec2 uv = latlong_from_dir(dirs[k].cast<double>().normalized());
    const int column = std::min(static_cast<int>(uv.x() * 1000), 999),
              row = std::min(static_cast<int>(uv.y() * 500), 499);
    differing += offsets[k] != map.pixel(column, row) - map.row(0);
  }
  EXPECT_LE(differing, 8) << "more than rounding at the pixels' borders";
}

Image<float> patchy_map(Size size) {
  Image<float> map(size, 3);
  Random random(3, 3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < 3; ++c) map(x, y, c) = x % 7 == 0 ? 0.0f : 0.1f + random.uniform_float() * (1.0f + c);
  for (int c = 0; c < 3; ++c) map(size.width / 3, size.height / 4, c) = 5000;
  return map;
}

Rgb whole_light(View<const float> map) {
  Rgb sum = Rgb::Zero();
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x)
      sum += latlong_pixel_solid_angle(y, map.width(), map.height()) * Rgb(map(x, y, 0), map(x, y, 1), map(x, y, 2));
  return sum;
}

// Drawn from every stratum, light adds up to the map's; so does luminance, exactly, whatever is drawn.
TEST(LightStrata, HaveAllOfTheMapsLight) {
  for (const Size size : {Size{96, 48}, Size{2050, 1025}}) {
    const Image<float> map = patchy_map(size);
    const Rgb whole = whole_light(map);
    for (const bool even : {true, false}) {
      if (!even && size.width > 1024) continue;  // noise has thousands of levels' components: slow, and no new path
      const LightStrata strata = even ? LightStrata::grid(map, 60) : LightStrata::structured(map, 60);
      EXPECT_GE(strata.count(), 40);
      Random random(4, 4);
      Rgb mean = Rgb::Zero();
      constexpr int kDraws = 400;
      for (int draw = 0; draw < kDraws; ++draw) {
        double luminances = 0;
        for (int stratum = 0; stratum < strata.count(); ++stratum) {
          const LightStrata::Sample sample = strata.sample(stratum, {random.uniform(), random.uniform()});
          EXPECT_NEAR(sample.dir.norm(), 1, 1e-5);
          mean += sample.light.cast<double>() / kDraws;
          luminances += luminance<double>(sample.light[0], sample.light[1], sample.light[2]);
        }
        ASSERT_NEAR(luminances, luminance(whole[0], whole[1], whole[2]), 1e-4 * whole[1]);
      }
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / whole[c], 1, 0.01) << "channel " << c;
    }
  }
}

TEST(LightStrata, OfABlackMapAreNone) {
  const Image<float> black(32, 16, 3);
  EXPECT_EQ(LightStrata::grid(black, 8).count(), 0);
  EXPECT_EQ(LightStrata::structured(black, 8).count(), 0);
}

// Noise in one corner of a picture: the work goes there, as much as there is, and not by what the pixel itself shows.
TEST(Allotment, GoesWhereTheNeighboursAreNoisy) {
  const Size size{40, 20};
  Film film(size);
  Random random(5, 5);
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const double noise = x < 20 ? 0.3 * random.normal() : 0.0;
        const bool quiet = x == 8 && y == 8;
        film.add(film.index(x, y), {Rgb::Constant(1 + (quiet ? 0.0 : noise)), Vec3f::UnitY(), 1}, 16);
      }
    }
  }
  const std::vector<float> deviations = relative_deviations(film);
  EXPECT_GT(deviations[film.index(8, 8)], 0.5f) << "a pixel that is quiet by chance is judged by its neighbours";
  EXPECT_EQ(deviations[film.index(30, 10)], 0);
  const double budget = 16 * 800;
  const Allotment spent = allot_budget(film, deviations, budget, 16);
  double sum = 0;
  for (std::size_t k = 0; k < film.count(); ++k)
    if (spent.levels[k] >= 0) sum += spent.directions(spent.levels[k]);
  EXPECT_LE(sum, budget);
  EXPECT_GT(sum, 0.7 * budget);
  EXPECT_EQ(spent.levels[film.index(30, 10)], -1);
  // Standard error .3 * 4 / sqrt(n) = .1 needs 144 directions; 32 are there.
  const Allotment to_error = allot_to_error(film, deviations, 0.1, 16, 1000);
  EXPECT_GE(to_error.levels[film.index(8, 8)], 1);
  EXPECT_EQ(to_error.levels[film.index(30, 10)], -1);
  EXPECT_EQ(allot_to_error(film, deviations, 1.0, 16, 1000).highest, -1) << "all there";
}

}  // namespace
}  // namespace hdr
