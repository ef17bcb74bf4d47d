// Pictures of hostile scenes: triangles without area, vertices that are no numbers, suns of 1e12, cameras inside what
// they see; one to 64 threads.
#include "libhdr/render/render.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/render/framing.h"
#include "tests/stress/hostile.h"

namespace hdr::stress {
namespace {

Material any_material() {
  Material material;
  material.kind = *rc::gen::element(MaterialKind::kDiffuse, MaterialKind::kGgx, MaterialKind::kMirror,
                                    MaterialKind::kPhong, MaterialKind::kMetallicRough);
  material.color = Rgbf::Constant(*rc::gen::element(0.0f, 0.5f, 1.0f));
  material.roughness = *rc::gen::element(0.0f, 1e-4f, 0.3f, 1.0f);
  material.exponent = *rc::gen::element(1e-6f, 1.0f, 1e6f);
  material.metallic = *rc::gen::element(0.0f, 0.5f, 1.0f);
  return material;
}

/// A soup: slivers, points, one vertex thrice, coordinates of 1e-6 .. 1e6.
Mesh soup(std::uint64_t seed, double size, const Material& material) {
  Mesh mesh;
  mesh.material = material;
  Random random(seed, 5);
  for (int k = 0; k < 30; ++k) {
    mesh.positions.emplace_back(Vec3(random.normal(), random.normal(), random.normal()).cast<float>() *
                                static_cast<float>(size));
  }
  for (int k = 0; k < 20; ++k) {
    for (int j = 0; j < 3; ++j) {
      mesh.indices.push_back(k % 4 == 0 && j > 0 ? mesh.indices.back() : random.bits() % 30);
    }
  }
  return mesh;
}

RC_GTEST_PROP(RenderStress, PicturesAreLightForAnyNumberOfThreads, ()) {
  const MapPlan plan = *any_latlong(16);
  const Environment light(made(plan),
                          *rc::gen::element(Environment::Density::kLuminance, Environment::Density::kCompensated));
  Scene scene;
  const double size = *power_of_ten(-3, 3);
  scene.meshes.push_back(soup(plan.seed, size, any_material()));
  scene.camera.eye = Vec3f(0, 0, static_cast<float>(*rc::gen::element(0.0, 0.5, 5.0) * size));
  scene.camera.look = Vec3f(0, 0, static_cast<float>(-size));
  RenderOptions options;
  options.method = static_cast<RenderMethod>(*rc::gen::inRange(0, 11));
  options.size = {*rc::gen::element(1, 5, 9), *rc::gen::element(1, 7)};
  options.samples = *rc::gen::element(1, 2, 5);
  options.filter = *rc::gen::element(FilmFilter::kBox, FilmFilter::kBlackmanHarris);
  options.error = *rc::gen::element(0.0, 0.1);
  const auto rendered = [&](int thread_count) {
    set_threads(thread_count);
    Rendering result = render(scene, light, options);
    set_threads(0);
    return result;
  };
  try {
    const Rendering one = rendered(1);
    RC_ASSERT(fault_of(one.picture.rgb) == "");
    RC_ASSERT(fault_of(one.picture.alpha) == "");
    RC_ASSERT(std::isfinite(one.estimated_error));
    const Rendering many = rendered(*rc::gen::inRange(2, 65));
    for (int y = 0; y < options.size.height; ++y) {
      RC_ASSERT(std::memcmp(one.picture.rgb.row(y), many.picture.rgb.row(y),
                            one.picture.rgb.row_samples() * sizeof(float)) == 0);
    }
  } catch (const Error& e) {
    RC_ASSERT(std::strlen(e.what()) > 10u);
  }
}

TEST(RenderStress, VerticesThatAreNoNumbersAreRefusedOrLeftOut) {
  Image<float> map(8, 4, 3);
  for (int y = 0; y < 4; ++y) std::fill_n(map.row(y), 24, 1.0f);
  const Environment light(std::move(map));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30f}) {
    Scene scene = sphere_alone(Material{});
    scene.meshes[0].positions[7].x() = bad;
    RenderOptions options;
    options.size = {16, 16};
    options.samples = 4;
    try {
      EXPECT_EQ(fault_of(render(scene, light, options).picture.rgb), "") << bad;
    } catch (const Error& e) {
      EXPECT_GT(std::strlen(e.what()), 10u);
    }
  }
}

}  // namespace
}  // namespace hdr::stress
