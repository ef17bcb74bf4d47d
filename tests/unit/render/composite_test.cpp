// Differential rendering against truth: a scene that is rendered whole, and the same put together.
#include "libhdr/render/composite.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/colour_chart.h"

namespace hdr {
namespace {

Environment sunny() {
  const Vec3 sun = Vec3(0.5, 0.7, 0.6).normalized();
  Image<float> map(128, 64, 3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 128; ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / 128, (y + 0.5) / 64);
      const double light = (d.y() > 0 ? 1.0 : 0.3) + (d.dot(sun) > std::cos(6 * kDegree) ? 80.0 : 0.0);
      for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(light * (1 + 0.1 * c));
    }
  }
  return Environment(std::move(map));
}

constexpr Size kSize{64, 48};

RenderOptions options_of(int samples) {
  RenderOptions options;
  options.method = RenderMethod::kMis;
  options.size = kSize;
  options.samples = samples;
  return options;
}

Scene ball_on_ground(bool catcher, const Rgbf& albedo) {
  Scene scene;
  Material ground;
  ground.color = albedo;
  ground.shadow_catcher = catcher;
  scene.meshes.push_back(plane_mesh(3, 0, ground));
  scene.meshes.push_back(sphere_mesh({0, 0.7f, 0}, 0.6f, material_from_text("diffuse:0.6")));
  scene.camera = {{0, 2.2f, 5}, {0, 0.4f, 0}, 50};
  return scene;
}

Scene without_ball(Scene scene) {
  scene.meshes.pop_back();
  return scene;
}

TEST(Composite, WithoutObjectsThePhotographStaysToTheBit) {
  const Environment light = sunny();
  const Scene ground = without_ball(ball_on_ground(true, Rgbf::Constant(0.4f)));
  Image<float> photograph(kSize, 3);
  for (int y = 0; y < kSize.height; ++y)
    for (int k = 0; k < 3 * kSize.width; ++k)
      photograph.row(y)[k] = 0.1f + 0.013f * static_cast<float>((7 * y + k) % 61);
  const RadianceMap result = composited(photograph, render_differential(ground, light, options_of(16)), 1);
  for (int y = 0; y < kSize.height; ++y)
    for (int k = 0; k < 3 * kSize.width; ++k) ASSERT_EQ(result.rgb.row(y)[k], photograph.row(y)[k]) << k << ", " << y;
}

TEST(Composite, FarFromTheObjectNothingChanges) {
  // A ball behind the camera, and one above a ground that it does not shade from anywhere: hidden below it.
  Scene scene = ball_on_ground(true, Rgbf::Constant(0.4f));
  for (Vec3f& p : scene.meshes[1].positions) p.y() -= 3;
  Image<float> photograph(kSize, 3);
  for (int y = 0; y < kSize.height; ++y)
    for (int k = 0; k < 3 * kSize.width; ++k) photograph.row(y)[k] = 0.5f + 0.01f * static_cast<float>(k % 11);
  const RadianceMap result = composited(photograph, render_differential(scene, sunny(), options_of(16)), 1);
  for (int y = 0; y < kSize.height; ++y)
    for (int k = 0; k < 3 * kSize.width; ++k)
      ASSERT_NEAR(result.rgb.row(y)[k], photograph.row(y)[k], 1e-6f) << "a ball under the ground, which hides it";
}

// The photograph is a render of the ground alone, its albedo unknown; the composite must be the render of all.
TEST(Composite, IsTheSceneRenderedWhole) {
  const Environment light = sunny();
  const Rgbf albedo(0.45f, 0.35f, 0.25f);
  const Scene whole = ball_on_ground(false, albedo);
  RenderOptions fine = options_of(1024);
  const Rendering truth = render(whole, light, fine);
  fine.seed = 2;
  const Rendering photograph = render(without_ball(whole), light, fine);

  Scene guess = ball_on_ground(true, Rgbf::Constant(0.5f));
  RenderOptions quick = options_of(64);
  const Rendering alone = render(without_ball(guess), light, quick);
  const std::optional<Rgbf> found = ground_albedo(photograph.picture.rgb, alone.ground, Rgbf::Constant(0.5f));
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found / albedo - 1).abs().maxCoeff(), 0.02f) << found->transpose();
  guess.meshes[0].material.color = *found;
  RenderOptions good = options_of(1024);
  good.seed = 3;
  const RadianceMap result = composited(photograph.picture.rgb, render_differential(guess, light, good), 1);
  double squares = 0, sum = 0, shadow = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int k = 0; k < 3 * kSize.width; ++k) {
      const double t = truth.picture.rgb.row(y)[k], d = result.rgb.row(y)[k] - t;
      squares += d * d;
      sum += t;
      shadow = std::max(shadow, 1 - t / photograph.picture.rgb.row(y)[k]);
    }
  }
  const double count = 3.0 * kSize.width * kSize.height;
  RecordProperty("relative_rms", std::to_string(std::sqrt(squares / count) / (sum / count)));
  EXPECT_GT(shadow, 0.5) << "this scene should have a shadow";
  EXPECT_LT(std::sqrt(squares / count) / (sum / count), 0.02);
}

TEST(Composite, CutOutLaysTheSamePictureOverAnyPhotograph) {
  const Differential differential =
      render_differential(ball_on_ground(true, Rgbf::Constant(0.4f)), sunny(), options_of(64));
  const RadianceMap layer = cut_out(differential);
  Image<float> grey(kSize, 3);
  for (int y = 0; y < kSize.height; ++y) std::fill_n(grey.row(y), 3 * kSize.width, 0.7f);
  const RadianceMap whole = composited(grey, differential, 1);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      // A shadow's colour is lost in one alpha: luminance is compared.
      const auto luminance = [](const float* p) { return 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2]; };
      const float over = luminance(layer.rgb.pixel(x, y)) + 0.7f * (1 - layer.alpha(x, y));
      EXPECT_NEAR(over, luminance(whole.rgb.pixel(x, y)), 0.02f) << x << ", " << y;
    }
  }
}

TEST(Composite, SameForAnyNumberOfThreads) {
  const Scene scene = ball_on_ground(true, Rgbf::Constant(0.4f));
  set_threads(1);
  const RadianceMap one = cut_out(render_differential(scene, sunny(), options_of(8)));
  set_threads(2);
  const RadianceMap two = cut_out(render_differential(scene, sunny(), options_of(8)));
  set_threads(0);
  for (int y = 0; y < kSize.height; ++y)
    for (int k = 0; k < 3 * kSize.width; ++k) ASSERT_EQ(one.rgb.row(y)[k], two.rgb.row(y)[k]);
}

// What each patch shows under an even light is its published colour.
TEST(ColourChart, PatchesHaveTheirColours) {
  const std::array<Rgbf, 24> chart = colour_checker();
  EXPECT_NEAR(chart[18][1], 0.896, 0.002) << "white is 90 %";
  EXPECT_NEAR(chart[21][1], 0.195, 0.002) << "neutral 5 is about 19 %";
  EXPECT_NEAR(chart[23][1], 0.034, 0.001) << "black is 3 %";
  for (const Rgbf& patch : chart) EXPECT_TRUE((patch > 0).all() && (patch < 1).all());
  // In the picture: row by row from the upper left.
  Image<float> white(16, 8, 3);
  for (int y = 0; y < 8; ++y) std::fill_n(white.row(y), 48, 1.0f);
  Scene scene = colour_chart_set();
  scene.camera = {{4, 0.62f, 0}, {0, 0.62f, 0}, 30};
  RenderOptions options = options_of(64);
  options.size = {120, 80};
  const Rendering r = render(scene, Environment(std::move(white)), options);
  const double half = std::tan(15 * kDegree), scale = 60 / (half * 4.2);  // pixels a unit at the chart
  for (int k = 0; k < 24; ++k) {
    const double z = 0.3 * (2.5 - k % 6), y = 1.24 - 0.3 * (k / 6 + 0.5) - 0.02 - 0.62 + 0.02;
    const int px = static_cast<int>(60 - z * scale), py = static_cast<int>(40 - y * scale);
    // The plane takes some of the sky from it: the ratio of the channels stays.
    const float* p = r.picture.rgb.pixel(px, py);
    const Rgbf& c = chart[static_cast<std::size_t>(k)];
    EXPECT_NEAR(p[0] / p[1], c[0] / c[1], 0.05 * c[0] / c[1]) << k;
    EXPECT_NEAR(p[2] / p[1], c[2] / c[1], 0.05 * c[2] / c[1]) << k;
  }
}

}  // namespace
}  // namespace hdr
