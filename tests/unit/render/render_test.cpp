// Laws of light on pictures: what must come out, whatever the method.
#include "libhdr/render/render.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>

#include "libhdr/core/color.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/sh.h"
#include "libhdr/render/internal/camera_rays.h"
#include "tests/support/rounds.h"
#include "tests/unit/render/many_seeds.h"

namespace hdr::test {
namespace {

TEST(Render, ConstantProbeGivesAlbedoTimesLEverywhere) {
  const Scene scene = sphere_alone(material_from_text("diffuse:0.6"));
  for (const RenderMethod method :
       {RenderMethod::kMc, RenderMethod::kMis, RenderMethod::kSh, RenderMethod::kImportance}) {
    RenderOptions options{method, {48, 36}, 16, 1, {}};
    const Environment light = constant_probe(2);
    const Truth truth = many_seeds(scene, light, options, 10);
    double sum = 0;
    int covered = 0;
    for (int y = 0; y < 36; ++y) {
      for (int x = 0; x < 48; ++x) {
        if (truth.alpha(x, y) < 1) continue;
        const double expected = 0.6 * luminance(2.0, 2.2, 2.4);
        // Ten seeds: nine degrees of freedom have long tails, 8 of their sigma is one pixel in 100000. No noise at all
        // in mc and sh.
        EXPECT_NEAR(truth.mean(x, y), expected, 8 * truth.error(x, y) + 1e-5)
            << name_of(method) << " at " << x << "," << y << ": a dark ring, or energy from nowhere";
        sum += truth.mean(x, y) / expected;
        ++covered;
      }
    }
    ASSERT_GT(covered, 400);
    EXPECT_NEAR(sum / covered, 1, 0.005) << name_of(method);
  }
}

TEST(Render, FacetsCastNoShadowOnTheirOwnSphere) {
  // A triangle without area far away makes the scene no longer convex: every shadow ray is traced, and the picture is
  // the same to the last bit.
  const Scene alone = sphere_alone(material_from_text("diffuse:0.6"));
  Scene traced = sphere_alone(material_from_text("diffuse:0.6"));
  Mesh nothing;
  nothing.positions.assign(3, Vec3f(9, 9, 9));
  nothing.indices = {0, 1, 2};
  traced.meshes.push_back(nothing);
  const Environment light = sunny_probe();
  for (const RenderMethod method : kUnbiased) {
    const RenderOptions options{method, {64, 48}, 16, 3, {}};
    const Rendering skipped = render(alone, light, options), full = render(traced, light, options);
    EXPECT_NE(skipped.skipped.find("shadow rays"), std::string::npos);
    EXPECT_TRUE(full.skipped.empty());
    EXPECT_LT(skipped.rays, full.rays) << name_of(method);
    for (int y = 0; y < 48; ++y) {
      EXPECT_EQ(0, std::memcmp(skipped.picture.rgb.row(y), full.picture.rgb.row(y), 64 * 3 * sizeof(float)))
          << name_of(method) << " row " << y;
    }
  }
}

TEST(Render, SphericalHarmonicsAgreeWithMonteCarloOnAnUnoccludedSphere) {
  const Scene scene = sphere_alone(material_from_text("diffuse:0.5"));
  const Environment light = soft_probe();
  const Truth sh = many_seeds(scene, light, {RenderMethod::kSh, {32, 24}, 16, 1, {}}, 8);
  for (const RenderMethod method : kUnbiased) {
    expect_same_light(many_seeds(scene, light, {method, {32, 24}, 16, 1, {}}, 12), sh,
                      std::string("sh against ") + name_of(method));
  }
}

TEST(Render, MethodsAgreeOnTheOccludedScene) {
  const Scene scene = spheres_on_plane();
  const Environment light = sunny_probe();
  const Size size{40, 30};
  const Truth mis = many_seeds(scene, light, {RenderMethod::kMis, size, 36, 1, {}}, 12);
  expect_same_light(many_seeds(scene, light, {RenderMethod::kImportance, size, 36, 1, {}}, 12), mis, "importance, mis");
  expect_same_light(many_seeds(scene, light, {RenderMethod::kStructured, size, 36, 1, {}}, 24), mis, "structured, mis");
  expect_same_light(many_seeds(scene, light, {RenderMethod::kAuto, size, 36, 1, {}}, 24), mis, "auto, mis");
  // Without importance the sun is met so seldom that its z-scores are not normal: a wider sun for mc.
  const Environment soft = soft_probe();
  expect_same_light(many_seeds(scene, soft, {RenderMethod::kMc, size, 36, 1, {}}, 12),
                    many_seeds(scene, soft, {RenderMethod::kMis, size, 36, 1, {}}, 12), "mc, mis");
}

TEST(Render, ShadowOfASphereLiesWhereGeometryPutsIt) {
  Scene scene;
  const Vec3 centre(0, 1.5, 0);
  scene.meshes.push_back(plane_mesh(20, 0, material_from_text("diffuse:0.5")));
  scene.meshes.push_back(sphere_mesh(centre.cast<float>(), 0.5f, material_from_text("diffuse:0.5")));
  scene.camera = {{0, 6, 6}, {0, 0, 0}, 50};
  // One pixel of sun in a black sky.
  const Size probe_size{720, 360};
  Image<float> map(probe_size, 3);
  for (int c = 0; c < 3; ++c) map(250, 100, c) = 1e6f;
  const Vec3 sun = dir_from_latlong(250.5 / 720, 100.5 / 360);
  const double irradiance = 1e6 * latlong_pixel_solid_angle(100, 720, 360) * sun.y();
  const Size size{160, 120};
  const Rendering r = render(scene, Environment(std::move(map)), {RenderMethod::kImportance, size, 16, 1, {}});

  const CameraRays camera(scene.camera, size);
  int lit = 0, dark = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Vec3 d = camera.dir_from_px({x + 0.5, y + 0.5}).cast<double>(), eye = camera.eye().cast<double>();
      const double to_centre = (centre - eye).cross(d).norm();
      if (to_centre < 0.55 || d.y() > -0.05) continue;  // the sphere itself and its edge, the horizon
      const Vec3 ground = eye - d * (eye.y() / d.y());
      if (ground.cwiseAbs().maxCoeff() > 19) continue;
      const double from_axis = (centre - ground).cross(sun).norm();
      if (std::abs(from_axis - 0.5) < 0.06) continue;  // penumbra and the pixel's own size
      const double expected = from_axis < 0.5 ? 0 : 0.5 * irradiance / kPi;
      EXPECT_NEAR(r.picture.rgb(x, y, 1), expected, 1e-3 * irradiance) << "at " << ground.transpose();
      (from_axis < 0.5 ? dark : lit)++;
    }
  }
  EXPECT_GT(dark, 50);
  EXPECT_GT(lit, 1000);
}

TEST(Render, MirrorShowsTheProbeInTheMirrorDirection) {
  const Scene scene = sphere_alone(material_from_text("mirror"));
  const Environment light(probe_of({360, 180}, [](const Vec3& d) { return 2 + d.x() + 0.5 * d.y() - 0.3 * d.z(); }));
  const Size size{120, 90};
  const Rendering r = render(scene, light, {RenderMethod::kMis, size, 4, 1, {}});
  const CameraRays camera(scene.camera, size);
  int tested = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Vec3 d = camera.dir_from_px({x + 0.5, y + 0.5}).cast<double>(), eye = camera.eye().cast<double>();
      // Where the ray meets the unit sphere: |eye + t d| = 1.
      const double b = eye.dot(d), under_root = b * b - eye.squaredNorm() + 1;
      if (under_root < 0.05) continue;  // the rim, where a pixel spans much of the world
      const Vec3 n = eye + (-b - std::sqrt(under_root)) * d;
      const Vec3 reflected = d - 2 * d.dot(n) * n;
      const double expected = 2 + reflected.x() + 0.5 * reflected.y() - 0.3 * reflected.z();
      EXPECT_NEAR(r.picture.rgb(x, y, 0), expected, 0.1) << "normal " << n.transpose();
      ++tested;
    }
  }
  EXPECT_GT(tested, 1000);
}

TEST(Render, WhiteMaterialsAreWhiteInAFurnace) {
  // By each unbiased method, over the whole ball: of a rough lobe a few samples in a hundred go below the horizon, too
  // few in one pixel to know its error from the spread of some renders.
  const Environment light = constant_probe(1);
  std::vector<Material> materials{material_from_text("diffuse:1"), material_from_text("mirror")};
  for (const float roughness : {0.05f, 0.4f, 1.0f}) {
    materials.push_back({MaterialKind::kGgx, Rgbf::Ones(), roughness});
    materials.push_back({MaterialKind::kMetallicRough, Rgbf::Ones(), roughness});
  }
  for (const Material& material : std::span(materials).last(rounds(materials.size()))) {
    for (const RenderMethod method : kUnbiased) {
      if (method == RenderMethod::kImportance && material.roughness < 0.1f) continue;  // light alone misses the lobe
      const Truth truth = many_seeds(sphere_alone(material), light, {method, {21, 15}, 64, 1, {}}, 8);
      double sum = 0, error2 = 0;
      int count = 0;
      for (int y = 0; y < 15; ++y) {
        for (int x = 0; x < 21; ++x) {
          if (truth.alpha(x, y) < 1) continue;
          sum += truth.mean(x, y);
          error2 += truth.error(x, y) * truth.error(x, y);
          ++count;
        }
      }
      ASSERT_GT(count, 50);
      const double expected = luminance(1.0, 1.1, 1.2);
      EXPECT_NEAR(sum / count, expected, 3 * std::sqrt(error2) / count + 0.004 * expected)
          << static_cast<int>(material.kind) << " of roughness " << material.roughness << " by " << name_of(method);
    }
  }
}

TEST(Render, GgxMethodsAgree) {
  const Scene scene = sphere_alone(material_from_text("ggx:0.5"));
  const Environment light = soft_probe();
  const Truth mis = many_seeds(scene, light, {RenderMethod::kMis, {32, 24}, 36, 1, {}}, 12);
  const Truth importance = many_seeds(scene, light, {RenderMethod::kImportance, {32, 24}, 36, 1, {}}, 12);
  expect_same_light(importance, mis, "ggx: importance, mis");
  expect_same_light(many_seeds(scene, light, {RenderMethod::kMc, {32, 24}, 36, 1, {}}, 12), mis, "ggx: mc, mis");
}

TEST(Render, WhiteFurnaceIsWhiteInEveryUnbiasedMethod) {
  const Environment furnace = constant_probe(1);
  const double white = luminance(1.0, 1.1, 1.2);
  const std::array materials{"diffuse:1", "mirror"};
  for (const char* material : std::span(materials).first(rounds(materials.size()))) {
    for (const RenderMethod method :
         {RenderMethod::kMc, RenderMethod::kPixels, RenderMethod::kImportance, RenderMethod::kStructured,
          RenderMethod::kMis, RenderMethod::kAuto, RenderMethod::kSh, RenderMethod::kShAo, RenderMethod::kMeanAo}) {
      Material of_sphere = material_from_text(material);
      if (of_sphere.kind == MaterialKind::kMirror) of_sphere.color = Rgbf::Ones();
      const MeanLight got = mean_light(sphere_alone(of_sphere), furnace, {method, {24, 18}, 16, 1, {}}, 8);
      // Eight seeds: the standard error is itself known to a quarter.
      EXPECT_NEAR(got.mean, white, 3 * 1.5 * got.error + 1e-4 * white) << material << " by " << name_of(method);
    }
  }
}

TEST(Render, AoOfAPlaneUnderASphereIsWhatGeometrySays) {
  // Straight below a sphere of radius r whose centre is h above: the sphere takes (r / h)^2 of the cosine-weighted sky.
  Scene scene;
  scene.meshes.push_back(plane_mesh(50, 0, material_from_text("diffuse:0.2")));
  scene.meshes.push_back(sphere_mesh({0, 2, 0}, 1, material_from_text("mirror"), 256));
  scene.camera = {{1.5f, 0.4f, 0}, {0, 0, 0}, 3};
  const Rendering r = render(scene, sunny_probe(), {RenderMethod::kAo, {9, 9}, 8192, 1, {}});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(r.picture.rgb(4, 4, c), 0.75, 0.01) << "neither albedo nor probe takes part";
}

}  // namespace
}  // namespace hdr::test
