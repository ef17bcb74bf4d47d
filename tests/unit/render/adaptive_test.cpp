// What a render says of its own error, and how it spends rays on it.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/render/render.h"
#include "tests/unit/render/many_seeds.h"

namespace hdr::test {
namespace {

TEST(Render, EstimatedErrorIsTheTrueOne) {
  for (const int samples : {4, 16, 64}) {
    const RenderOptions options{RenderMethod::kMc, {32, 24}, samples, 1, {}};
    // Diffuse spheres that float: where they touch the plane, and where gloss mirrors it, what little light there is
    // would decide the relative error.
    Scene scene = spheres_on_plane();
    scene.meshes[0] = plane_mesh(8, -0.4f, scene.meshes[0].material);
    scene.meshes[2].material = scene.meshes[1].material;
    const Environment light = soft_probe();
    const Truth truth = many_seeds(scene, light, options, 20);
    double relative_variance = 0;
    int count = 0;
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 32; ++x) {
        if (truth.alpha(x, y) < 1) continue;
        relative_variance += std::pow(truth.deviation(x, y) / truth.mean(x, y), 2);
        ++count;
      }
    }
    const double error = std::sqrt(relative_variance / count);
    const double estimated = render(scene, light, options).estimated_error;
    EXPECT_GT(estimated, error / 1.5) << samples << " samples";
    EXPECT_LT(estimated, error * 1.5) << samples << " samples";
  }
}

// Stopping where the estimate looks good prefers pixels that missed the light by chance [Tamstorf97]: shadow edges and
// small suns would come out too dark.
TEST(Render, StoppingAtAnErrorAddsNoBias) {
  const Scene scene = spheres_on_plane();
  const Environment light = sunny_probe();
  const Size size{40, 30};
  const MeanLight even = mean_light(scene, light, {RenderMethod::kMis, size, 144, 1, {}}, 10);
  for (const double error : {0.3, 0.1}) {
    RenderOptions options{RenderMethod::kAuto, size, 4096, 1, {}};
    options.error = error;
    const MeanLight stopped = mean_light(scene, light, options, 20);
    EXPECT_NEAR(stopped.mean / even.mean, 1, 3.5 * std::hypot(stopped.error, even.error) / even.mean + 5e-4)
        << "at error " << error;
  }
}

TEST(Render, StopsAtTheErrorAndSpendsNothingOnPixelsThatAreThere) {
  Scene scene = spheres_on_plane();
  scene.meshes[2].material = scene.meshes[3].material = scene.meshes[1].material;
  const Environment light = sunny_probe();
  const Size size{64, 48};
  const Truth truth = many_seeds(scene, light, {RenderMethod::kMis, size, 400, 1, {}}, 6);
  for (const double error : {0.2, 0.05}) {
    RenderOptions options{RenderMethod::kMis, size, 1 << 14, 1, {}};
    options.error = error;
    const Rendering r = render(scene, light, options);
    double relative = 0, mean = 0;
    int count = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) mean += truth.mean(x, y) / (size.width * size.height);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        if (truth.alpha(x, y) < 1) continue;
        const float* p = r.picture.rgb.pixel(x, y);
        const double t = truth.mean(x, y);
        relative += std::pow(luminance<double>(p[0], p[1], p[2]) - t, 2) / (t * t + 0.01 * mean * mean);
        ++count;
      }
    }
    EXPECT_LT(std::sqrt(relative / count), 1.3 * error) << "asked for " << error;
    EXPECT_LE(r.estimated_error, 2 * error) << "of which deep shadows have the most";
    EXPECT_LT(r.samples_per_pixel, 1 << 13);
    EXPECT_GE(r.samples_per_pixel, 32);
    if (error > 0.1) continue;
    // The same work everywhere does less.
    const Rendering even =
        render(scene, light, {RenderMethod::kMis, size, static_cast<int>(r.samples_per_pixel), 1, {}});
    EXPECT_GT(even.estimated_error, r.estimated_error) << "asked for " << error;
  }
}

TEST(Render, AutoSaysWhatItChoseAndWhy) {
  const Scene alone = sphere_alone(material_from_text("diffuse:0.5"));
  const Rendering soft = render(alone, soft_probe(), {RenderMethod::kAuto, {24, 18}, 16, 1, {}});
  EXPECT_EQ(soft.method, RenderMethod::kSh);
  EXPECT_NE(soft.method_reason.find("nothing can occlude"), std::string::npos) << soft.method_reason;
  EXPECT_NE(soft.skipped.find("error at most"), std::string::npos) << soft.skipped;
  const Rendering sunny = render(alone, sunny_probe(), {RenderMethod::kAuto, {24, 18}, 16, 1, {}});
  EXPECT_EQ(sunny.method, RenderMethod::kMis);
  EXPECT_NE(sunny.method_reason.find("% of the probe's light"), std::string::npos) << sunny.method_reason;
  // From inside the sphere nothing is lit, whatever the harmonics say.
  Scene inside = alone;
  inside.camera = {{0, 0, 0.5f}, {0, 0, -1}, 60};
  const Rendering dark = render(inside, soft_probe(), {RenderMethod::kAuto, {24, 18}, 16, 1, {}});
  EXPECT_NE(dark.method, RenderMethod::kSh);
  EXPECT_EQ(dark.picture.rgb(12, 9, 1), 0);
}

}  // namespace
}  // namespace hdr::test
