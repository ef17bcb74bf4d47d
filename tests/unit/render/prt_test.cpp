// Transfer against Monte Carlo in the same projected light, and meshes on their way to it.
#include "libhdr/render/prt.h"

#include <gtest/gtest.h>

#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/render.h"
#include "libhdr/render/tracer.h"

namespace hdr {
namespace {

Sh some_light(int degree, std::uint64_t seed) {
  Random random(seed, 1);
  Sh sh{degree, {}};
  for (int k = 0; k < (degree + 1) * (degree + 1); ++k)
    sh.coefficients.emplace_back(random.normal(), random.normal(), random.normal());
  sh.coefficients[0] += 6;
  return sh;
}

Vec3f cosine_direction(const Vec3f& n, Random& random) {
  Vec3f t, b;
  tangents_from_normal(n, t, b);
  const double u = random.uniform(), phi = 2 * kPi * random.uniform(), r = std::sqrt(u);
  return static_cast<float>(r * std::cos(phi)) * t + static_cast<float>(r * std::sin(phi)) * b +
         static_cast<float>(std::sqrt(1 - u)) * n;
}

TEST(Prt, AConvexMeshHasTheIrradianceOfTheHarmonics) {
  Scene scene;
  scene.meshes.push_back(sphere_mesh({0, 0, 0}, 1, {}, 24));
  const Sh light = some_light(4, 2);
  const auto vertices = relit(diffuse_transfer(scene, {4, 64, 1, {}})[0], light);
  for (std::size_t v = 0; v < scene.meshes[0].positions.size(); ++v) {
    const Rgb expected = irradiance(light, scene.meshes[0].normals[v].cast<double>());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(vertices(static_cast<Eigen::Index>(v), c), expected[c], 1e-4) << v;
  }
}

TEST(Prt, ShadowsAreThoseOfMonteCarlo) {
  // A sphere on a plane: two meshes that shade each other.
  Scene scene;
  scene.meshes.push_back(tessellated(with_smooth_normals(plane_mesh(2, 0, {})), 0.6f));
  scene.meshes.push_back(sphere_mesh({0, 0.5f, 0}, 0.5f, {}, 16));
  const Sh light = some_light(4, 3);
  const std::vector<Transfer> transfer = diffuse_transfer(scene, {4, 4096, 1, {}});
  const Tracer tracer(scene);
  int beyond = 0, count = 0, shaded = 0;
  for (std::size_t m = 0; m < 2; ++m) {
    const Mesh& mesh = scene.meshes[m];
    const auto vertices = relit(transfer[m], light);
    for (std::size_t v = 0; v < mesh.positions.size(); v += 3) {
      Random random(4, v);
      const Vec3f origin = mesh.positions[v] + transfer_lift(mesh) * mesh.normals[v];
      constexpr int kRays = 2000;
      double sum = 0, squares = 0;
      for (int k = 0; k < kRays; ++k) {
        const Vec3f dir = cosine_direction(mesh.normals[v], random);
        const double value =
            tracer.occluded(origin, dir) ? 0 : kPi * evaluate(light, dir.cast<double>().normalized())[1];
        sum += value;
        squares += value * value;
      }
      const double mean = sum / kRays, sigma = std::sqrt((squares / kRays - mean * mean) / kRays);
      const double seen = vertices(static_cast<Eigen::Index>(v), 1);
      beyond += std::abs(seen - mean) > 3 * sigma;
      shaded += std::abs(seen - irradiance(light, mesh.normals[v].cast<double>())[1]) > 6 * sigma;
      ++count;
    }
  }
  EXPECT_GT(shaded, 5) << "shadows should be seen in this scene";
  EXPECT_LE(beyond, std::max(1, count / 50)) << count << " vertices; three sigma leave one in 370 outside";
}

TEST(Prt, TurnedLightIsTheLightOnATurnedMesh) {
  Scene scene;
  scene.meshes.push_back(sphere_mesh({0, 0, 0}, 1, {}, 16));
  const Transfer transfer = diffuse_transfer(scene, {4, 16, 1, {}})[0];
  const Sh light = some_light(4, 5);
  const Mat3 quarter = rotation_from_degrees({0, 90, 0});
  const auto plain = relit(transfer, light), turned = relit(transfer, rotated(light, quarter));
  // The sphere of 16 segments is its own quarter turn.
  const Mesh& mesh = scene.meshes[0];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f to = (quarter * mesh.positions[v].cast<double>()).cast<float>();
    for (std::size_t w = 0; w < mesh.positions.size(); ++w) {
      if ((mesh.positions[w] - to).norm() > 1e-4f) continue;
      EXPECT_NEAR(turned(static_cast<Eigen::Index>(w), 0), plain(static_cast<Eigen::Index>(v), 0), 1e-3);
    }
  }
}

TEST(Prt, RenderIsCloseToMonteCarloUnderASoftLight) {
  Image<float> map(64, 32, 3);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) {
        const Vec3 d = dir_from_latlong((x + 0.5) / 64, (y + 0.5) / 32);
        map(x, y, c) = static_cast<float>(1 + 0.6 * d.y() + 0.3 * d.x() * d.z() + 0.1 * c);
      }
  const Environment light(std::move(map));
  Scene scene = spheres_on_plane();
  for (Mesh& mesh : scene.meshes) mesh.material = {};
  const Rendering prt = render(scene, light, {RenderMethod::kPrt, {64, 48}, 16, 1, {}, {}});
  const Rendering mc = render(scene, light, {RenderMethod::kMc, {64, 48}, 256, 1, {}, {}});
  double off = 0, sum = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      off += std::abs(prt.picture.rgb(x, y, 1) - mc.picture.rgb(x, y, 1));
      sum += mc.picture.rgb(x, y, 1);
    }
  EXPECT_LT(off / sum, 0.02);
}

TEST(Prt, SameForAnyNumberOfThreads) {
  Scene scene;
  scene.meshes.push_back(tessellated(with_smooth_normals(plane_mesh(2, 0, {})), 1));
  scene.meshes.push_back(sphere_mesh({0, 0.5f, 0}, 0.5f, {}, 8));
  set_threads(1);
  const auto one = diffuse_transfer(scene, {2, 64, 1, {}});
  set_threads(2);
  const auto two = diffuse_transfer(scene, {2, 64, 1, {}});
  set_threads(0);
  for (std::size_t m = 0; m < 2; ++m) EXPECT_TRUE((one[m].vectors.array() == two[m].vectors.array()).all());
}

TEST(Tessellation, KeepsAreaAndShortensEdges) {
  const Mesh fine = tessellated(plane_mesh(1, 0, {}), 0.3f);
  double area = 0;
  for (std::size_t t = 0; t < fine.indices.size(); t += 3) {
    const auto p = [&](std::size_t k) { return fine.positions[fine.indices[t + k]]; };
    area += 0.5 * (p(1) - p(0)).cross(p(2) - p(0)).norm();
    EXPECT_LE((p(1) - p(0)).norm(), 0.3f);
    EXPECT_GT((p(1) - p(0)).cross(p(2) - p(0)).y(), 0) << "wound as before";
  }
  EXPECT_NEAR(area, 4, 1e-5);
}

}  // namespace
}  // namespace hdr
