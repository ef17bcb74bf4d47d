// Openness by depth maps against openness by rays.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/render/internal/depth_map.h"
#include "libhdr/render/render.h"

namespace hdr {
namespace {

Environment grey_probe() {
  Image<float> map(4, 2, 3);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 12; ++x) map.row(y)[x] = 1;
  return Environment(std::move(map));
}

TEST(DepthMap, SeesTheSkyBesideAnOccluderAndNotBelowIt) {
  Scene scene;
  scene.meshes.push_back(plane_mesh(4, 0, {}));
  scene.meshes.push_back(plane_mesh(1, 1, {}));
  const Vec3f up(0, 1, 0);
  const DepthMap map(scene, up, {-4, 0, -4}, {4, 1, 4}, 256);
  EXPECT_EQ(map.open({0.3f, 0, 0.2f}, up), 0);
  EXPECT_EQ(map.open({2, 0, 0.2f}, up), 1);
  EXPECT_EQ(map.open({0.3f, 1, 0.2f}, up), 1) << "on top of it";
  // Within a texel of the edge, in between.
  const float edge = map.open({1 + 0.25f * 8 / 256, 0, 0.2f}, up);
  EXPECT_GE(edge, 0);
  EXPECT_LE(edge, 1);
}

// A plane does not shade itself, however flat it is looked at.
TEST(DepthMap, APlaneIsOpenFromAnyDirection) {
  Scene scene;
  scene.meshes.push_back(plane_mesh(3, 0, {}));
  for (const Vec3f& towards : {Vec3f(0.1f, 1, 0), Vec3f(1, 0.2f, 0.3f), Vec3f(-0.7f, 0.05f, 0.7f)}) {
    const DepthMap map(scene, towards.normalized(), {-3, 0, -3}, {3, 0, 3}, 128);
    for (float x = -2.9f; x < 2.9f; x += 0.17f)
      EXPECT_NEAR(map.open({x, 0, 0.31f * x}, {0, 1, 0}), 1, 1e-5f) << towards;
  }
}

TEST(DepthMaps, ShowTheOpennessThatRaysShow) {
  const Scene scene = spheres_on_plane();
  constexpr Size kSize{120, 90};
  const Rendering rays = render(scene, grey_probe(), {RenderMethod::kAo, kSize, 1024, 1, {}});
  RenderOptions options{RenderMethod::kAo, kSize, 1, 1, {}};
  options.depth_maps = 512;
  const Rendering maps = render(scene, grey_probe(), options);
  EXPECT_EQ(maps.samples_per_pixel, 512);
  double sum = 0, absolute = 0;
  int count = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      if (rays.picture.alpha(x, y) < 1) continue;
      const auto difference = static_cast<double>(maps.picture.rgb(x, y, 1) - rays.picture.rgb(x, y, 1));
      sum += difference;
      absolute += std::abs(difference);
      ++count;
    }
  }
  RecordProperty("mean_difference", std::to_string(sum / count));
  // Texels and their margin leave light in where things touch.
  EXPECT_NEAR(sum / count, 0.003, 0.006);
  EXPECT_LT(absolute / count, 0.02);
}

TEST(DepthMaps, AreForOpennessAlone) {
  RenderOptions options{RenderMethod::kMis, {8, 6}, 4, 1, {}};
  options.depth_maps = 16;
  EXPECT_THROW(render(spheres_on_plane(), grey_probe(), options), Error);
  options.method = RenderMethod::kShAo;
  EXPECT_NO_THROW(render(spheres_on_plane(), grey_probe(), options));
}

}  // namespace
}  // namespace hdr
