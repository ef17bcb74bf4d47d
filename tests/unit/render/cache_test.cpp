// The irradiance cache, from its borders' derivatives to its pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/split_lights.h"
#include "libhdr/render/internal/irradiance_record.h"
#include "libhdr/render/internal/lambert_edge.h"
#include "libhdr/render/internal/record_octree.h"
#include "libhdr/render/render.h"
#include "tests/unit/render/many_seeds.h"

namespace hdr::test {
namespace {

Scene grey_spheres() {
  Scene scene = spheres_on_plane();
  for (Mesh& mesh : scene.meshes) mesh.material = material_from_text("diffuse:0.5");
  return scene;
}

// A square above the surface, as Lambert's formula and as a sum over its points.
TEST(LambertEdge, OfAPolygonAddUpToItsIrradiance) {
  const Vec3 corners[] = {{0.2, -0.3, 0.8}, {1.2, -0.2, 0.9}, {1.1, 0.9, 1.1}, {0.1, 0.7, 1.0}};
  const Vec3 n = Vec3(0.1, -0.2, 1).normalized();
  double by_edges = 0, by_points = 0;
  for (int k = 0; k < 4; ++k) by_edges += lambert_edge(corners[k], corners[(k + 1) % 4], n).value;
  // The corners are not in one plane: seen from the origin only their directions count, and two triangles fan them.
  constexpr int kSteps = 400;
  for (int half = 0; half < 2; ++half) {
    const Vec3 a = corners[0], b = corners[1 + half], c = corners[2 + half];
    const Vec3 area = (b - a).cross(c - a);
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; i + j < kSteps; ++j) {
        const int both = i + j + 1 < kSteps ? 2 : 1;
        for (int part = 0; part < both; ++part) {
          const double u = (i + (part + 1) / 3.0) / kSteps, v = (j + (part + 1) / 3.0) / kSteps;
          const Vec3 p = a + u * (b - a) + v * (c - a);
          const double r2 = p.squaredNorm();
          by_points += 0.5 / (kSteps * kSteps) * std::abs(area.dot(p)) * n.dot(p) / (r2 * r2);
        }
      }
    }
  }
  EXPECT_NEAR(by_edges, by_points, 1e-4 * by_points);
}

TEST(LambertEdge, DerivativesAreThoseOfTheFormula) {
  const Vec3 a(0.4, -0.3, 0.8), b(1.1, 0.5, 0.3), n = Vec3(0.2, -0.1, 0.9).normalized();
  const LambertEdge edge = lambert_edge(a, b, n);
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = kStep * Vec3::Unit(i);
    const LambertEdge forth = lambert_edge(a - step, b - step, n), back = lambert_edge(a + step, b + step, n);
    EXPECT_NEAR(edge.gradient[i], (forth.value - back.value) / (2 * kStep), 1e-7);
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(edge.hessian(i, j), (forth.gradient[j] - back.gradient[j]) / (2 * kStep), 1e-6);
  }
  EXPECT_EQ(lambert_edge(a, 3 * a, n).value, 0) << "no angle";
}

TEST(SplitLights, AddUpToTheMapAndTakeTheSun) {
  const Image<float> map = probe_of({256, 128}, sunny_light);
  const SplitLights split = split_lights(map);
  int suns = 0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(split.soft(x, y, c) + split.compact(x, y, c), map(x, y, c), 1e-5f * map(x, y, c));
        EXPECT_GE(split.compact(x, y, c), 0);
      }
      suns += split.compact(x, y, 1) > 0;
      EXPECT_EQ(split.compact(x, y, 1) > 0, map(x, y, 1) > 100);
    }
  }
  EXPECT_GT(suns, 10);
  // 150 in a disc of four degrees against a mean of .65.
  const double sun = 150 * 2 * kPi * (1 - std::cos(4 * kDegree)), all = sun + 4 * kPi * 0.65;
  EXPECT_NEAR(split.share, sun / all, 0.04);
  EXPECT_EQ(split_lights(probe_of({64, 32}, soft_light)).share, 0) << "a soft probe has none";
}

// Gradients say what the irradiance of points near by is, within the noise of many records.
TEST(IrradianceRecord, GradientsForetellWhatIsNearBy) {
  const Scene scene = grey_spheres();
  const Tracer tracer(scene);
  const Image<float> sky = probe_of({64, 32}, soft_light);
  const RecordMaker maker(tracer, sky, nullptr);
  const Vec3f ground(-1.1f, 0.001f, 0.9f), up(0, 1, 0);
  const auto mean_of = [&](const Vec3f& at, const Vec3f& normal) {
    IrradianceRecord mean = maker.record({at, normal, 0.01f, 3.0f}, 512, 0, *std::make_unique<std::int64_t>(0));
    mean.loss.setZero(), mean.by_rotation.setZero(), mean.by_translation.setZero();
    constexpr int kRecords = 256;
    for (int k = 0; k < kRecords; ++k) {
      std::int64_t rays = 0;
      const IrradianceRecord one =
          maker.record({at, normal, 0.01f, 3.0f}, 512, static_cast<std::uint64_t>(k) + 1, rays);
      EXPECT_GT(rays, 400);
      mean.loss += one.loss / kRecords;
      mean.by_rotation += one.by_rotation / kRecords;
      mean.by_translation += one.by_translation / kRecords;
    }
    return mean;
  };
  const IrradianceRecord here = mean_of(ground, up);
  EXPECT_GT(here.loss[1], 0.1f);
  for (const Vec3f& step : {Vec3f(0.08f, 0, 0), Vec3f(0, 0, 0.08f)}) {
    const float change = (mean_of(ground + step, up).loss - mean_of(ground - step, up).loss)[1];
    const float foretold = 2 * here.by_translation.row(1).dot(step);
    EXPECT_NEAR(foretold, change, 0.05f) << "a fifth of the steeper slope";
  }
  for (const Vec3f& tilt : {Vec3f(0.1f, 0, 0), Vec3f(0, 0, 0.1f)}) {
    const Vec3f forth = (up + tilt).normalized(), back = (up - tilt).normalized();
    const float change = (mean_of(ground, forth).loss - mean_of(ground, back).loss)[1];
    const float foretold = here.by_rotation.row(1).dot(up.cross(forth) - up.cross(back));
    EXPECT_NEAR(foretold, change, 0.15f * std::abs(change) + 0.01f);
  }
}

TEST(RecordOctree, FindsWhatReaches) {
  RecordOctree tree({0, 0, 0}, 4);
  IrradianceRecord record{};
  record.normal = {0, 1, 0};
  record.by_rotation.setZero();
  record.by_translation.setZero();
  for (int k = 0; k < 40; ++k) {
    record.position = {-3.9f + 0.2f * static_cast<float>(k), 0, 0};
    record.loss = Rgbf::Constant(static_cast<float>(k));
    record.radius = 0.25f;
    record.metric = Eigen::Matrix3f::Identity() / (record.radius * record.radius);
    tree.add(record);
  }
  EXPECT_EQ(tree.size(), 40u);
  const Rgbf sky = Rgbf::Constant(100);
  for (float x = -3.8f; x < 3.8f; x += 0.07f) {
    const auto said = tree.loss({x, 0, 0}, {0, 1, 0}, sky);
    ASSERT_TRUE(said);
    EXPECT_NEAR(said->loss[0], (x + 3.9f) / 0.2f, 0.5f) << "a mean of those on both sides";
    EXPECT_FALSE(tree.loss({x, 0.4f, 0}, {0, 1, 0}, sky)) << "too far";
    EXPECT_FALSE(tree.loss({x, 0, 0}, {1, 0, 0}, sky)) << "another normal";
  }
}

// Records of a parabola that know its slope err by its bend: a at distance 1 from y = a x^2.
TEST(RecordOctree, DoubtIsHowFarOffTheRecordsAre) {
  constexpr float kBend = 3, kReach = 0.5f, kSky = 100;
  RecordOctree tree({0, 0, 0}, 8);
  for (int k = -40; k <= 40; ++k) {
    const float x = 0.1f * static_cast<float>(k);
    IrradianceRecord record{};
    record.normal = {0, 1, 0};
    record.by_rotation.setZero();
    record.by_translation.setZero();
    record.by_translation.col(0) = Vec3f::Constant(2 * kBend * x);
    record.position = {x, 0, 0};
    record.loss = Rgbf::Constant(kBend * x * x);
    record.radius = kReach;
    record.metric = Eigen::Matrix3f::Identity() / (kReach * kReach);
    tree.add(record);
  }
  const std::vector<Rgbf> skies(tree.size(), Rgbf::Constant(kSky));
  tree.doubt(skies);
  const auto doubts = [&] {
    double sum = 0;
    for (float x = -3; x < 3; x += 0.07f)
      sum += static_cast<double>(tree.loss({x, 0, 0}, {0, 1, 0}, Rgbf::Constant(kSky))->doubt);
    return sum;
  };
  for (float x = -3; x < 3; x += 0.07f) {
    const auto said = tree.loss({x, 0, 0}, {0, 1, 0}, Rgbf::Constant(kSky));
    const float off = std::abs(said->loss[0] - kBend * x * x);
    EXPECT_GT(off, 0.01f) << "all records lie below the parabola: their spread would not tell";
    EXPECT_NEAR(said->doubt, off, 0.3f * off);
  }
  const double of_the_bend = doubts();
  // Noise that is another the next time is no doubt.
  double noisy = 0;
  for (int pass = 0; pass < 2; ++pass) {
    Random random(5, static_cast<std::uint64_t>(pass));
    for (IrradianceRecord& record : tree.records()) {
      const float x = record.position.x(), noise = static_cast<float>(random.uniform()) - 0.5f;
      record.loss = Rgbf::Constant(kBend * x * x + noise);
    }
    tree.doubt(skies);
    noisy = doubts();
  }
  EXPECT_NEAR(noisy, of_the_bend, 0.3 * of_the_bend);
}

struct Difference {
  double rms = 0, bias = 0;
};

Difference between(const Rendering& a, const Rendering& b) {
  double squares = 0, sum = 0;
  int count = 0;
  for (int y = 0; y < a.picture.rgb.height(); ++y) {
    for (int x = 0; x < a.picture.rgb.width(); ++x) {
      if (a.picture.alpha(x, y) < 1 || b.picture.alpha(x, y) < 1) continue;
      const auto level = [&](const Rendering& r) {
        const float* p = r.picture.rgb.pixel(x, y);
        return static_cast<double>(luminance(p[0], p[1], p[2]));
      };
      const double relative = level(a) / level(b) - 1;
      squares += relative * relative;
      sum += relative;
      ++count;
    }
  }
  return {std::sqrt(squares / count), sum / count};
}

TEST(Render, CacheShowsWhatMonteCarloShows) {
  const Scene scene = grey_spheres();
  constexpr Size kSize{120, 90};
  for (const bool sunny : {false, true}) {
    const Environment light(probe_of({256, 128}, sunny ? sunny_light : soft_light));
    const Rendering truth = render(scene, light, {sunny ? RenderMethod::kMis : RenderMethod::kMc, kSize, 4096, 77, {}});
    const Rendering cached = render(scene, light, {RenderMethod::kCache, kSize, 64, 1, {}});
    const Difference off = between(cached, truth);
    // Pixels where things touch are dark, and their relative errors large.
    EXPECT_LT(off.rms, 0.05) << (sunny ? "sunny" : "soft");
    EXPECT_LT(std::abs(off.bias), 0.006) << (sunny ? "sunny" : "soft");
    // It knows of what interpolation adds, and not only of noise.
    EXPECT_LT(cached.estimated_error, 2 * off.rms + 0.002) << (sunny ? "sunny" : "soft");
    EXPECT_GT(cached.estimated_error, 0.5 * off.rms) << (sunny ? "sunny" : "soft");
  }
}

TEST(Render, CacheHasTheSameBytesForAnyNumberOfThreads) {
  const Environment light(probe_of({128, 64}, sunny_light));
  RenderOptions options{RenderMethod::kCache, {60, 45}, 8, 7, {}};
  for (const int bounces : {0, 1}) {
    options.bounces = bounces;
    set_threads(1);
    const Rendering one = render(spheres_on_plane(), light, options);
    set_threads(2);
    const Rendering two = render(spheres_on_plane(), light, options);
    set_threads(0);
    EXPECT_EQ(one.rays, two.rays);
    for (int y = 0; y < 45; ++y)
      EXPECT_EQ(0, std::memcmp(one.picture.rgb.row(y), two.picture.rgb.row(y), 60 * 3 * sizeof(float))) << "row " << y;
  }
}

}  // namespace
}  // namespace hdr::test
