// The camera that sees all of a scene, and textures.
#include "libhdr/render/framing.h"

#include <gtest/gtest.h>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/camera_rays.h"
#include "libhdr/render/texture.h"

namespace hdr {
namespace {

// Where a point falls in the picture: its middle is 0, its sides are -1 and 1.
Vec2 in_picture(const Camera& camera, double aspect, const Vec3& p) {
  const Vec3 eye = camera.eye.cast<double>(), ahead = (camera.look.cast<double>() - eye).normalized();
  const Vec3 right = ahead.cross(Vec3::UnitY()).normalized(), up = right.cross(ahead), d = p - eye;
  const double half = std::tan(0.5 * camera.fov_degrees * kDegree);
  EXPECT_GT(d.dot(ahead), 0) << "behind the camera";
  return {d.dot(right) / (d.dot(ahead) * half), d.dot(up) / (d.dot(ahead) * half) * aspect};
}

TEST(Framing, EveryVertexIsSeenAndThePictureIsFull) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed, 3);
    const double scale = std::pow(10.0, 8 * random.uniform() - 4), aspect = std::pow(4.0, 2 * random.uniform() - 1);
    // Far from the origin, as long as floats can still tell the points apart.
    const Vec3 place =
        scale * std::pow(10.0, 3 * random.uniform()) * Vec3(random.normal(), random.normal(), random.normal());
    const Vec3 shape(random.uniform() < 0.2 ? 0 : random.uniform(), random.uniform() < 0.2 ? 0 : random.uniform(),
                     random.uniform());
    const double fov = 10 + 100 * random.uniform();
    Scene scene;
    Mesh mesh;
    for (int k = 0; k < 30; ++k) {
      const Vec3 p(random.normal(), random.normal(), random.normal());
      mesh.positions.push_back((place + scale * shape.cwiseProduct(p)).cast<float>());
      mesh.indices.push_back(static_cast<std::uint32_t>(k));
    }
    scene.meshes.push_back(mesh);
    const Camera camera = framing_camera(scene, aspect, fov);
    Vec2 low(9, 9), high(-9, -9);
    for (const Vec3f& p : mesh.positions) {
      const Vec2 at = in_picture(camera, aspect, p.cast<double>());
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    constexpr double kSide = 0.92, kRounding = 0.02;
    EXPECT_LT(std::max(-low.minCoeff(), high.maxCoeff()), kSide + kRounding) << seed;
    // Tight: one pair of sides is touched on both, or what is nearest is as near as it may be.
    const Vec3 eye = camera.eye.cast<double>(), ahead = (camera.look.cast<double>() - eye).normalized();
    double nearest = 1e300, extent = 0;
    for (const Vec3f& p : mesh.positions) {
      nearest = std::min(nearest, (p.cast<double>() - eye).dot(ahead));
      for (const Vec3f& q : mesh.positions) extent = std::max(extent, static_cast<double>((p - q).norm()));
    }
    const bool at_the_lens = nearest < std::max(0.04 * extent, 2e-4 * place.norm());
    const bool across = low.x() < -kSide + kRounding && high.x() > kSide - kRounding;
    const bool upwards = low.y() < -kSide + kRounding && high.y() > kSide - kRounding;
    EXPECT_TRUE(across || upwards || at_the_lens) << seed << ": " << low.transpose() << " to " << high.transpose();
    CameraRays(camera, {40, 30});  // is a camera
  }
}

TEST(Framing, APointAndNothing) {
  Scene scene;
  EXPECT_THROW(framing_camera(scene, 1), Error);
  Mesh point;
  point.positions = {{1e6f, 2, 3}};
  point.indices = {0, 0, 0};
  scene.meshes.push_back(point);
  const Camera camera = framing_camera(scene, 1.5);
  EXPECT_GT((camera.eye - camera.look).norm(), 0.5f);
  EXPECT_TRUE(camera.eye.allFinite());
  EXPECT_THROW(framing_camera(scene, 1, 180), Error);
}

TEST(Camera, UpIsAtTheTopOfThePicture) {
  const Camera rolled{{0, 0, 5}, {0, 0, 0}, 60, {1, 0, 0}};
  const CameraRays rays(rolled, {100, 100});
  EXPECT_GT(rays.dir_from_px({50, 0}).x(), 0.4f);
  EXPECT_GT(rays.dir_from_px({0, 50}).y(), 0.4f) << "turned by a quarter";
  const Camera useless{{0, 0, 5}, {0, 0, 0}, 60, {0, 0, 0}};
  EXPECT_GT(CameraRays(useless, {100, 100}).dir_from_px({50, 0}).y(), 0.4f);
}

TEST(Texture, MeetsItsTexelsAndGoesOnBeyond) {
  Texture texture;
  texture.texels = Image<float>(4, 2, 3);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 3; ++c) texture.texels(x, y, c) = static_cast<float>(10 * y + x + 100 * c);
  const auto at = [&](float u, float v) { return texture.at(Vec2f(u, v))[0]; };
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / 4, v = 1 - (static_cast<float>(y) + 0.5f) / 2;
      EXPECT_NEAR(at(u, v), 10 * y + x, 1e-4) << "v = 0 is the lowest row";
      EXPECT_NEAR(at(u + 5, v - 3), 10 * y + x, 1e-3) << "repeats";
    }
  EXPECT_NEAR(at(0.25f, 0.75f), 0.5f, 1e-4) << "between two texels";
  EXPECT_NEAR(at(0, 0.75f), 1.5f, 1e-4) << "the seam: half of texel 3, half of texel 0";
  EXPECT_FLOAT_EQ(texture.at(Vec2f(0.125f, 0.75f))[2], 200);
  texture.wrap_u = Wrap::kMirror;
  EXPECT_NEAR(at(1.125f, 0.75f), 3, 1e-4);
  EXPECT_NEAR(at(-0.125f, 0.75f), 0, 1e-4);
  EXPECT_NEAR(at(1.875f, 0.75f), 0, 1e-4);
  texture.wrap_u = texture.wrap_v = Wrap::kClamp;
  EXPECT_NEAR(at(7, 0.75f), 3, 1e-4);
  EXPECT_NEAR(at(-7, -7), 10, 1e-4);
  for (const float odd : {NAN, INFINITY, -INFINITY, 1e30f, -1e30f}) EXPECT_TRUE(std::isfinite(at(odd, odd)));
}

}  // namespace
}  // namespace hdr
