// What comes out of bad, small and dark scenes, and of any number of threads.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/render.h"
#include "tests/unit/render/many_seeds.h"

namespace hdr::test {
namespace {

TEST(Render, BadScenesAreEmptyPicturesNotCrashes) {
  const Environment light = sunny_probe();
  const Material grey = material_from_text("diffuse:0.5");
  Scene none;
  Scene degenerate = spheres_on_plane(), broken = spheres_on_plane();
  Mesh nothing;
  nothing.material = grey;
  nothing.positions.assign(3, Vec3f(0, 1, 0));
  nothing.indices = {0, 1, 2, 0, 0, 0};
  degenerate.meshes.push_back(nothing);
  for (Vec3f& p : nothing.positions) p = Vec3f::Constant(std::nanf(""));
  broken.meshes.push_back(nothing);
  Scene inside = spheres_on_plane();
  inside.camera.eye = Vec3f(0, 0.65f, 0);
  inside.camera.look = Vec3f(1, 0.65f, 0);
  for (const Scene* scene : {&none, &degenerate, &broken, &inside}) {
    for (const RenderMethod method : {RenderMethod::kAuto, RenderMethod::kMc, RenderMethod::kStructured,
                                      RenderMethod::kAo, RenderMethod::kSh, RenderMethod::kShAo}) {
      const Rendering r = render(*scene, light, {method, {24, 18}, 16, 1, {}});
      for (int y = 0; y < 18; ++y)
        for (int x = 0; x < 24 * 3; ++x) ASSERT_TRUE(std::isfinite(r.picture.rgb.row(y)[x])) << name_of(method);
    }
  }
}

TEST(Render, SameBytesForAnyNumberOfThreads) {
  const Scene scene = spheres_on_plane();
  const Environment light = sunny_probe();
  const RenderOptions options{RenderMethod::kAuto, {60, 45}, 8, 7, {}};
  set_threads(1);
  const Rendering one = render(scene, light, options);
  set_threads(2);
  const Rendering two = render(scene, light, options);
  set_threads(0);
  EXPECT_EQ(one.rays, two.rays);
  EXPECT_EQ(one.estimated_error, two.estimated_error);
  for (int y = 0; y < 45; ++y) {
    EXPECT_EQ(0, std::memcmp(one.picture.rgb.row(y), two.picture.rgb.row(y), 60 * 3 * sizeof(float))) << "row " << y;
  }
}

TEST(Render, BackdropIsTheProbeAndAlphaIsCoverage) {
  const Environment light = constant_probe(3);
  const Rendering r =
      render(sphere_alone(material_from_text("diffuse:1")), light, {RenderMethod::kMc, {64, 48}, 64, 1, {}});
  EXPECT_EQ(r.picture.alpha(0, 0), 0);
  EXPECT_EQ(r.picture.alpha(32, 24), 1);
  // A white sphere in a furnace cannot be told from its backdrop, edges included.
  double covered = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      EXPECT_NEAR(r.picture.rgb(x, y, 0), 3, 1e-4);
      covered += r.picture.alpha(x, y);
    }
  }
  // The outline of a unit sphere at 4.5 is a circle of radius tan(asin(1 / 4.5)) one unit ahead.
  const double radius_px = 32 / std::tan(20 * kDegree) * std::tan(std::asin(1 / 4.5));
  EXPECT_NEAR(covered / (kPi * radius_px * radius_px), 1, 0.005);
}

TEST(Render, OneSampleAndOnePixelAreAPicture) {
  const Rendering r = render(spheres_on_plane(), constant_probe(1), {RenderMethod::kMis, {1, 1}, 1, 1, {}});
  EXPECT_TRUE(std::isfinite(r.picture.rgb(0, 0, 0)));
  EXPECT_EQ(r.estimated_error, 1) << "one sample tells nothing of its error";
}

TEST(Render, BlackProbeGivesABlackPicture) {
  const Rendering r = render(spheres_on_plane(), constant_probe(0), {RenderMethod::kMis, {16, 12}, 16, 1, {}});
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 48; ++x) EXPECT_EQ(r.picture.rgb.row(y)[x], 0);
  EXPECT_EQ(r.estimated_error, 0);
}

TEST(Render, BadOptionsAreErrors) {
  const Environment light = constant_probe(1);
  Scene scene = spheres_on_plane();
  EXPECT_THROW(render(scene, light, {RenderMethod::kMis, {0, 10}, 16, 1, {}}), Error);
  EXPECT_THROW(render(scene, light, {RenderMethod::kMis, {10, 10}, 0, 1, {}}), Error);
  scene.camera.look = scene.camera.eye;
  EXPECT_THROW(render(scene, light, {RenderMethod::kMis, {10, 10}, 16, 1, {}}), Error);
}

}  // namespace
}  // namespace hdr::test
