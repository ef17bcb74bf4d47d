// Laws of light that hold for every material and every method, of random scenes and few samples too.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>

#include "libhdr/core/random.h"
#include "libhdr/light/sh.h"
#include "libhdr/render/internal/camera_rays.h"
#include "tests/support/rounds.h"
#include "tests/unit/render/many_seeds.h"

namespace hdr::test {
namespace {

constexpr RenderMethod kOfLight[] = {RenderMethod::kMc,         RenderMethod::kPixels, RenderMethod::kImportance,
                                     RenderMethod::kStructured, RenderMethod::kMis,    RenderMethod::kAuto,
                                     RenderMethod::kCache};

// What returns all light that it gets, whatever it is made of.
Material white_material(Random& random) {
  Material material;
  material.color = Rgbf::Ones();
  material.roughness = static_cast<float>(random.uniform());
  switch (static_cast<int>(4 * random.uniform())) {
    case 0:
      material.kind = MaterialKind::kDiffuse;
      break;
    case 1:
      material.kind = MaterialKind::kGgx;
      break;
    case 2:
      material.kind = MaterialKind::kMirror;
      break;
    default:
      material.kind = MaterialKind::kMetallicRough;
      material.metallic = static_cast<float>(random.uniform());
  }
  return material;
}

// Of a picture's mean over the ball, over seeds: mean and standard error.
MeanLight ball_light(const Material& material, const Environment& light, RenderMethod method, int samples, int seeds) {
  return mean_light(sphere_alone(material), light, {method, {21, 15}, samples, 1, {}}, seeds);
}

// Few samples are as right as many: 16 a pixel, 40 materials each by one of the methods.
TEST(Furnace, EveryWhiteMaterialIsWhiteByEveryMethod) {
  const Environment furnace = constant_probe(1);
  const double white = luminance(1.0, 1.1, 1.2);
  Random random(2024, 1);
  for (std::uint64_t k = 0; k < rounds(40); ++k) {
    const Material material = white_material(random);
    const RenderMethod method = kOfLight[static_cast<std::size_t>(random.uniform() * std::size(kOfLight))];
    // Directions of the light alone miss a lobe that is sharp.
    const bool light_alone = method == RenderMethod::kImportance;
    if (light_alone && material.kind != MaterialKind::kDiffuse && material.roughness < 0.3f) continue;
    const MeanLight got = ball_light(material, furnace, method, 16, 8);
    // Eight seeds know their own error to a quarter; the albedo table of rough gloss is good to three thousandths.
    const double table =
        material.kind == MaterialKind::kGgx || material.kind == MaterialKind::kMetallicRough ? 4e-3 : 1e-4;
    EXPECT_NEAR(got.mean / white, 1, 3 * 1.5 * got.error / white + table)
        << "case " << k << ": kind " << static_cast<int>(material.kind) << ", roughness " << material.roughness
        << ", metallic " << material.metallic << " by " << name_of(method);
  }
}

// Phong's lobe is cut by the horizon: head-on it returns all, elsewhere less, never more.
TEST(Furnace, PhongGivesNothingAway) {
  const Environment furnace = constant_probe(1);
  const double white = luminance(1.0, 1.1, 1.2);
  const std::array exponents{20.0f, 1.0f, 500.0f};
  for (const float exponent : std::span(exponents).first(rounds(exponents.size()))) {
    Material material = material_from_text("phong:1");
    material.exponent = exponent;
    material.color = Rgbf::Constant(0.6f);
    material.diffuse = Rgbf::Constant(0.4f);
    for (const RenderMethod method : {RenderMethod::kMc, RenderMethod::kMis}) {
      const MeanLight got = ball_light(material, furnace, method, 16, 8);
      EXPECT_LT(got.mean / white, 1 + 4.5 * got.error / white) << exponent << " by " << name_of(method);
      EXPECT_GT(got.mean / white, 0.7) << exponent << " by " << name_of(method);
    }
  }
}

// How much a render of the unit sphere has of a function of the normal, beside the constant pi, when the probe is
// luminance(1, 1.1, 1.2) times something.
double share_of(const Rendering& r, const Scene& scene, const std::function<double(const Vec3&)>& function) {
  const Size size = r.picture.rgb.size();
  const CameraRays camera(scene.camera, size);
  const double unit = luminance(1.0, 1.1, 1.2) / kPi;
  double by_function = 0, function2 = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Vec3 d = camera.dir_from_px({x + 0.5, y + 0.5}).cast<double>(), eye = camera.eye().cast<double>();
      const double b = eye.dot(d), under_root = b * b - eye.squaredNorm() + 1;
      if (under_root < 0.05 || r.picture.alpha(x, y) < 1) continue;
      const float* p = r.picture.rgb.pixel(x, y);
      const double f = function(eye + (-b - std::sqrt(under_root)) * d),
                   irradiance = luminance<double>(p[0], p[1], p[2]) / unit;
      by_function += (irradiance - kPi) * f;
      function2 += f * f;
    }
  }
  return by_function / function2;
}

// The probe 1 + Y_lm / 2 gives a surface with normal n the irradiance pi + A_l Y_lm(n) / 2 [Ramamoorthi01].
TEST(Furnace, ASphereUnderAHarmonicHasItsIrradiance) {
  constexpr double kCosineLobe[] = {kPi, 2 * kPi / 3, kPi / 4, 0};
  constexpr int kSeeds = 6;
  const Scene scene = sphere_alone(material_from_text("diffuse:1"));
  const std::array functions{6, 0, 1, 2, 3, 4, 5, 7, 8, 12};
  for (const int index : std::span(functions).first(rounds(functions.size()))) {
    const double expected = 0.5 * kCosineLobe[static_cast<int>(std::sqrt(index))];
    const auto harmonic = [&](const Vec3& d) {
      double basis[16];
      sh_basis(d, 3, basis);
      return basis[index];
    };
    const Environment light(probe_of({256, 128}, [&](const Vec3& d) { return 1 + 0.5 * harmonic(d); }));
    for (const RenderMethod method : kOfLight) {
      double mean = 0, squares = 0;
      for (int seed = 0; seed < kSeeds; ++seed) {
        const RenderOptions options{method, {32, 24}, 25, 900 + static_cast<std::uint64_t>(seed), {}};
        const double got = share_of(render(scene, light, options), scene, harmonic);
        const double step = got - mean;
        mean += step / (seed + 1);
        squares += step * (got - mean);
      }
      // Pixels' middles stand for pixels: half a hundredth.
      const double error = std::sqrt(squares / (kSeeds - 1) / kSeeds);
      EXPECT_NEAR(mean, expected, 3 * 1.6 * error + 0.005) << name_of(method) << ", function " << index;
    }
  }
}

}  // namespace
}  // namespace hdr::test
