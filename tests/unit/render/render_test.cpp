// Laws of light on pictures: what must come out, whatever the method.
#include "libhdr/render/render.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/sh.h"
#include "libhdr/render/internal/camera_rays.h"

namespace hdr {
namespace {

constexpr RenderMethod kUnbiased[] = {RenderMethod::kMc, RenderMethod::kImportance, RenderMethod::kMis};

Image<float> probe_of(Size size, const std::function<double(const Vec3&)>& radiance) {
  Image<float> map(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double value = radiance(dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height));
      for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(value * (1 + 0.1 * c));
    }
  }
  return map;
}

Environment constant_probe(double radiance) {
  return Environment(probe_of({16, 8}, [&](const Vec3&) { return radiance; }));
}

// Polynomials of degree 2: nine coefficients hold all of it but for the pixels' steps.
Environment soft_probe() {
  return Environment(
      probe_of({256, 128}, [](const Vec3& d) { return 1.2 + 0.6 * d.y() + 0.4 * d.x() * d.z() + 0.3 * d.z(); }));
}

// Sky, a darker ground and a small bright sun: what makes methods differ.
Environment sunny_probe() {
  const Vec3 sun = Vec3(0.5, 0.7, 0.6).normalized();
  return Environment(probe_of({128, 64}, [&](const Vec3& d) {
    return (d.y() > 0 ? 1.0 : 0.3) + (d.dot(sun) > std::cos(4 * kDegree) ? 150.0 : 0.0);
  }));
}

// Mean and its standard error of each pixel's luminance over renders with different seeds.
struct Truth {
  Image<double> mean, error, deviation;  ///< deviation: of one render
  Image<float> alpha;                    ///< the smallest of all seeds: 1 where no edge is near
};

Truth many_seeds(const Scene& scene, const Environment& light, RenderOptions options, int seeds) {
  Truth truth{Image<double>(options.size, 1), Image<double>(options.size, 1), Image<double>(options.size, 1),
              Image<float>(options.size, 1)};
  for (int seed = 0; seed < seeds; ++seed) {
    options.seed = 1000 + static_cast<std::uint64_t>(seed);
    const Rendering r = render(scene, light, options);
    for (int y = 0; y < options.size.height; ++y) {
      for (int x = 0; x < options.size.width; ++x) {
        const float* p = r.picture.rgb.pixel(x, y);
        const double value = luminance<double>(p[0], p[1], p[2]);
        const double step = value - truth.mean(x, y);
        truth.mean(x, y) += step / (seed + 1);
        truth.error(x, y) += step * (value - truth.mean(x, y));
      }
    }
    for (int y = 0; y < options.size.height; ++y) {
      for (int x = 0; x < options.size.width; ++x) {
        if (seed == 0 || r.picture.alpha(x, y) < truth.alpha(x, y)) truth.alpha(x, y) = r.picture.alpha(x, y);
      }
    }
  }
  for (int y = 0; y < options.size.height; ++y) {
    for (int x = 0; x < options.size.width; ++x) {
      truth.deviation(x, y) = std::sqrt(truth.error(x, y) / (seeds - 1));
      truth.error(x, y) = truth.deviation(x, y) / std::sqrt(static_cast<double>(seeds));
    }
  }
  return truth;
}

// z-scores of the difference of two estimates must look standard normal: bounds are those of 3 sigma for their mean,
// with room in the spread for standard errors that are themselves estimated.
void expect_same_light(const Truth& a, const Truth& b, const std::string& what) {
  double sum = 0, squares = 0, difference = 0, level = 0, error2 = 0;
  int count = 0;
  for (int y = 0; y < a.mean.height(); ++y) {
    for (int x = 0; x < a.mean.width(); ++x) {
      if (a.alpha(x, y) < 1) continue;
      const double d = a.mean(x, y) - b.mean(x, y);
      const double sigma = std::hypot(a.error(x, y), b.error(x, y)) + 1e-6 * a.mean(x, y);
      sum += d / sigma;
      squares += d * d / (sigma * sigma);
      difference += d;
      level += a.mean(x, y);
      error2 += sigma * sigma;
      ++count;
    }
  }
  ASSERT_GT(count, 100) << what;
  EXPECT_LT(std::abs(difference), 3 * std::sqrt(error2))
      << what << ": the pictures' means differ by " << 100 * difference / level << " %";
  EXPECT_LT(squares / count, 1.5) << what << ": mean square z-score of pixels";
}

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
  for (const Material& material : materials) {
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

// Mean and standard error over seeds of the picture's mean, of pixels that are always covered.
struct MeanLight {
  double mean = 0, error = 0;
};

MeanLight mean_light(const Scene& scene, const Environment& light, RenderOptions options, int seeds) {
  const Truth truth = many_seeds(scene, light, options, seeds);
  double squares = 0;
  MeanLight result;
  for (int seed = 0; seed < seeds; ++seed) {
    options.seed = 5000 + static_cast<std::uint64_t>(seed);
    const Rendering r = render(scene, light, options);
    double sum = 0;
    int count = 0;
    for (int y = 0; y < options.size.height; ++y) {
      for (int x = 0; x < options.size.width; ++x) {
        if (truth.alpha(x, y) < 1) continue;
        const float* p = r.picture.rgb.pixel(x, y);
        sum += luminance<double>(p[0], p[1], p[2]);
        ++count;
      }
    }
    const double step = sum / count - result.mean;
    result.mean += step / (seed + 1);
    squares += step * (sum / count - result.mean);
  }
  result.error = std::sqrt(squares / (seeds - 1) / seeds);
  return result;
}

TEST(Render, WhiteFurnaceIsWhiteInEveryUnbiasedMethod) {
  const Environment furnace = constant_probe(1);
  const double white = luminance(1.0, 1.1, 1.2);
  for (const char* material : {"diffuse:1", "mirror"}) {
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

TEST(Render, AoOfAPlaneUnderASphereIsWhatGeometrySays) {
  // Straight below a sphere of radius r whose centre is h above: the sphere takes (r / h)^2 of the cosine-weighted sky.
  Scene scene;
  scene.meshes.push_back(plane_mesh(50, 0, material_from_text("diffuse:0.2")));
  scene.meshes.push_back(sphere_mesh({0, 2, 0}, 1, material_from_text("mirror"), 256));
  scene.camera = {{1.5f, 0.4f, 0}, {0, 0, 0}, 3};
  const Rendering r = render(scene, sunny_probe(), {RenderMethod::kAo, {9, 9}, 8192, 1, {}});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(r.picture.rgb(4, 4, c), 0.75, 0.01) << "neither albedo nor probe takes part";
}

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
}  // namespace hdr
