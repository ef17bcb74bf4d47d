// Prefiltered light: a white furnace stays white, and a lobe sees what brute force sees.
#include "libhdr/light/prefilter.h"

#include <gtest/gtest.h>

#include "libhdr/light/cube.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

TEST(Prefilter, AWhiteFurnaceStaysWhite) {
  const Image<float> grey = test::constant_map({64, 32}, Rgbf(0.5f, 2, 7));
  const Prefilter prefilter(grey);
  for (const Lobe lobe : {Lobe::kGgx, Lobe::kPhong}) {
    for (const double roughness : {0.0, 0.1, 0.5, 1.0}) {
      const Image<float> map = prefilter.latlong({16, 8}, roughness, lobe, 64);
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x)
          for (int c = 0; c < 3; ++c) EXPECT_NEAR(map(x, y, c) / grey(0, 0, c), 1, 1e-5) << roughness;
    }
  }
}

// The same mean by summing every pixel of the map.
Rgb brute_force(View<const float> map, const Vec3& n, double roughness, Lobe lobe) {
  const double alpha2 = std::pow(roughness, 4), power = 2 / alpha2 - 2;
  Rgb sum = Rgb::Zero();
  double weight = 0;
  for (int y = 0; y < map.height(); ++y) {
    const double solid_angle = latlong_pixel_solid_angle(y, map.width(), map.height());
    for (int x = 0; x < map.width(); ++x) {
      const Vec3 l = dir_from_latlong((x + 0.5) / map.width(), (y + 0.5) / map.height());
      const double cosine = n.dot(l);
      if (cosine <= 0) continue;
      const double cos2_h = 0.5 * (1 + cosine), t = cos2_h * (alpha2 - 1) + 1;
      const double w = solid_angle * (lobe == Lobe::kGgx ? cosine * alpha2 / (t * t) : std::pow(cosine, power));
      const float* p = map.pixel(x, y);
      sum += w * Rgb(p[0], p[1], p[2]);
      weight += w;
    }
  }
  return sum / weight;
}

TEST(Prefilter, SeesWhatBruteForceSees) {
  const Image<float> map = test::lobes_map({256, 128}, 6, 40, 3);
  const Prefilter prefilter(map);
  Random random(1, 0);
  for (const Lobe lobe : {Lobe::kGgx, Lobe::kPhong}) {
    for (const double roughness : {0.3, 0.5, 0.8, 1.0}) {
      double worst = 0;
      for (int k = 0; k < 20; ++k) {
        const Vec3 n = test::random_dir(random);
        const Rgb expected = brute_force(map, n, roughness, lobe);
        worst = std::max(worst, (prefilter.mean(n, roughness, lobe, 512) / expected - 1).abs().maxCoeff());
      }
      EXPECT_LT(worst, 0.03) << "roughness " << roughness << (lobe == Lobe::kGgx ? " ggx" : " phong");
    }
  }
}

TEST(Prefilter, ASunIsSpreadNotLostNorFoundTwice) {
  Image<float> map = test::constant_map({256, 128}, Rgbf::Zero());
  for (int c = 0; c < 3; ++c) map(70, 50, c) = 1e6f;
  const Prefilter prefilter(map);
  const Vec3 sun = dir_from_latlong(70.5 / 256, 50.5 / 128);
  for (const double roughness : {0.4, 0.7, 1.0}) {
    const double expected = brute_force(map, sun, roughness, Lobe::kGgx)[0];
    EXPECT_NEAR(prefilter.mean(sun, roughness, Lobe::kGgx, 1024)[0] / expected, 1, 0.15) << roughness;
  }
}

TEST(Prefilter, FacesOfACubeAreTheSameMap) {
  const Image<float> map = test::lobes_map({128, 64}, 4, 20, 5);
  const Prefilter prefilter(map);
  const auto faces = prefilter.cube(5, 0.6, Lobe::kGgx, 128);
  for (int face = 0; face < 6; ++face) {
    const Vec3 middle = dir_from_cube_face(face, 0.5, 0.5);
    const Rgb expected = prefilter.mean(middle, 0.6, Lobe::kGgx, 128);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(faces[static_cast<std::size_t>(face)](2, 2, c), expected[c], 1e-5);
  }
  // The mirror shows the map where it is.
  const auto mirror = prefilter.cube(65, 0);
  const Vec3 d = dir_from_cube_face(4, 40.5 / 65, 20.5 / 65);
  const Vec2 uv = latlong_from_dir(d);
  EXPECT_NEAR(mirror[4](40, 20, 1) / map(static_cast<int>(uv.x() * 128), static_cast<int>(uv.y() * 64), 1), 1, 0.15);
}

}  // namespace
}  // namespace hdr
