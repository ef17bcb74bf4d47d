// Meshes, materials, rays and points.
#include "libhdr/render/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/camera_rays.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/tracer.h"

namespace hdr {
namespace {

TEST(Scene, SphereMeshIsClosedAndWoundOutwards) {
  const Vec3f centre(1, 2, 3);
  const Mesh mesh = sphere_mesh(centre, 2, {}, 32);
  // Every edge belongs to two triangles that run through it in opposite directions.
  std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;
  double volume = 0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) edges.insert({mesh.indices[t + k], mesh.indices[t + (k + 1) % 3]});
    const auto p = [&](std::size_t k) { return Vec3((mesh.positions[mesh.indices[t + k]] - centre).cast<double>()); };
    volume += p(0).dot(p(1).cross(p(2))) / 6;
  }
  for (const auto& [a, b] : edges) {
    EXPECT_EQ(edges.count({a, b}), 1u);
    EXPECT_EQ(edges.count({b, a}), 1u) << "an open edge";
  }
  EXPECT_NEAR(volume / (4.0 / 3 * kPi * 8), 1, 0.03) << "negative: wound inwards";
}

TEST(Scene, MaterialsFromText) {
  EXPECT_FLOAT_EQ(material_from_text("diffuse:0.25").color[1], 0.25f);
  EXPECT_EQ(material_from_text("ggx:0.4").kind, MaterialKind::kGgx);
  EXPECT_FLOAT_EQ(material_from_text("ggx:0.4").roughness, 0.4f);
  EXPECT_FLOAT_EQ(material_from_text("phong:120").exponent, 120);
  EXPECT_EQ(material_from_text("phong").kind, MaterialKind::kPhong);
  EXPECT_EQ(material_from_text("mirror").kind, MaterialKind::kMirror);
  for (const char* bad : {"", "glass", "diffuse:", "diffuse:2", "diffuse:-1", "diffuse:nan", "diffuse:0.5x", "mirror:1",
                          "phong:-1", "phong:x", "phong:1e9"}) {
    EXPECT_THROW(material_from_text(bad), Error) << bad;
  }
}

TEST(Camera, TheMiddleLooksAheadAndTheFieldIsHorizontal) {
  const Camera camera{{1, 2, 3}, {1, 2, -4}, 60};
  const CameraRays rays(camera, {400, 200});
  EXPECT_LT((rays.dir_from_px({200, 100}) - Vec3f(0, 0, -1)).norm(), 1e-6);
  const Vec3f right = rays.dir_from_px({400, 100}), top = rays.dir_from_px({200, 0});
  EXPECT_NEAR(right.x(), std::sin(30 * kDegree), 1e-6) << "looking along -Z, +X is on the right";
  EXPECT_NEAR(top.y() / -top.z(), 0.5 * std::tan(30 * kDegree), 1e-6);
}

TEST(Camera, CanLookStraightDown) {
  const CameraRays rays({{0, 5, 0}, {0, 0, 0}, 60}, {100, 100});
  EXPECT_LT((rays.dir_from_px({50, 50}) - Vec3f(0, -1, 0)).norm(), 1e-6);
  EXPECT_LT(rays.dir_from_px({50, 0}).z(), 0) << "-Z is at the top";
  EXPECT_GT(rays.dir_from_px({100, 50}).x(), 0);
}

TEST(Tracer, HitsLieOnTheSmoothSphereOutside) {
  const Scene scene = sphere_alone({});
  const Tracer tracer(scene);
  Random random(1, 0);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 from = 3 * Vec3(random.normal(), random.normal(), random.normal()).normalized();
    const Vec3 aim = 0.9 * Vec3(random.normal(), random.normal(), random.normal()).normalized();
    const Vec3f dir = (aim - from).normalized().cast<float>();
    const auto hit = tracer.intersect(from.cast<float>(), dir);
    ASSERT_TRUE(hit.has_value());
    EXPECT_TRUE(hit->front);
    EXPECT_LT(hit->geometric.dot(dir), 0);
    EXPECT_GT(hit->position.norm(), 1 - 1e-5f) << "inside: rays along the surface would meet facets";
    EXPECT_LT(hit->position.norm(), 1.002f);
    EXPECT_GT(hit->normal.dot(hit->position.normalized()), 0.998f);
    // No direction of the shading hemisphere is blocked by the sphere itself.
    Vec3f out = Vec3(random.normal(), random.normal(), random.normal()).normalized().cast<float>();
    if (out.dot(hit->normal) < 0) out = -out;
    EXPECT_FALSE(tracer.occluded(hit->position, out)) << "cosine " << out.dot(hit->normal);
    EXPECT_TRUE(tracer.occluded(hit->position, -hit->normal));
  }
}

TEST(Tracer, ConvexityIsSeen) {
  EXPECT_TRUE(Tracer(sphere_alone({})).convex());
  EXPECT_FALSE(Tracer(spheres_on_plane()).convex());
  Scene plane;
  plane.meshes.push_back(plane_mesh(3, 0, {}));
  EXPECT_TRUE(Tracer(plane).convex());
  Scene two = sphere_alone({});
  two.meshes.push_back(sphere_mesh({5, 0, 0}, 1, {}));
  EXPECT_FALSE(Tracer(two).convex());
  // A dent: one vertex of the sphere pushed in.
  Scene dented = sphere_alone({});
  dented.meshes[0].positions[2000] *= 0.9f;
  EXPECT_FALSE(Tracer(dented).convex());
}

TEST(Tracer, TheBackOfAnOpenShellIsNotItsFront) {
  Scene plane;
  plane.meshes.push_back(plane_mesh(3, 0, {}));
  const Tracer tracer(plane);
  EXPECT_TRUE(tracer.intersect({0, 1, 0}, {0, -1, 0})->front);
  const auto back = tracer.intersect({0, -1, 0}, {0, 1, 0});
  EXPECT_FALSE(back->front);
  EXPECT_LT(back->normal.y(), 0) << "the normal is on the viewer's side";
  EXPECT_LT(back->position.y(), 0);
}

TEST(Points, SobolPointsFillEachElementaryInterval) {
  for (const int count : {4, 16, 64, 256}) {
    for (std::uint64_t seed = 1; seed < 20; ++seed) {
      for (int columns = 1; columns <= count; columns *= 2) {
        std::set<int> boxes;
        for (int k = 0; k < count; ++k) {
          const Vec2 p = sobol_point(static_cast<std::uint32_t>(k), hash64(seed));
          ASSERT_TRUE(p.x() >= 0 && p.x() < 1 && p.y() >= 0 && p.y() < 1);
          const int rows = count / columns;
          boxes.insert(static_cast<int>(p.x() * columns) * rows + static_cast<int>(p.y() * rows));
        }
        EXPECT_EQ(boxes.size(), static_cast<std::size_t>(count)) << columns << " columns of " << count << " points";
      }
    }
  }
}

TEST(Points, ScrambledPointsAreUniform) {
  // The first point of many seeds: mean 1/2 and variance 1/12 in both components.
  Vec2 sum = Vec2::Zero(), squares = Vec2::Zero();
  constexpr int kSeeds = 20000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Vec2 p = sobol_point(3, hash64(static_cast<std::uint64_t>(seed)));
    sum += p;
    squares += p.cwiseAbs2();
  }
  const double sigma = std::sqrt(1.0 / 12 / kSeeds);
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(sum[axis] / kSeeds, 0.5, 4 * sigma);
    EXPECT_NEAR(squares[axis] / kSeeds, 1.0 / 3, 0.01);
  }
}

TEST(Points, StratifiedPointsHaveAStratumEach) {
  for (const int count : {1, 2, 5, 6, 12, 100}) {
    int m = static_cast<int>(std::sqrt(count));
    while (count % m != 0) --m;
    std::set<int> strata;
    for (int k = 0; k < count; ++k) {
      const Vec2 p = stratified_point(k, count, 9);
      strata.insert(static_cast<int>(p.x() * m) * (count / m) + static_cast<int>(p.y() * (count / m)));
    }
    EXPECT_EQ(strata.size(), static_cast<std::size_t>(count));
  }
}

}  // namespace
}  // namespace hdr
