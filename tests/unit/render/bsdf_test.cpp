// Each material: its sampler draws what its density says, its value and its density belong together, and it returns no
// more than it receives.
#include "libhdr/render/internal/bsdf.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/ggx.h"

namespace hdr {
namespace {

struct Named {
  std::string name;
  Material material;
};

Material metallic_rough(const Rgbf& base, float metallic, float roughness) {
  Material material;
  material.kind = MaterialKind::kMetallicRough;
  material.color = base;
  material.metallic = metallic;
  material.roughness = roughness;
  return material;
}

Material phong(float glossy, float diffuse, float exponent) {
  Material material;
  material.kind = MaterialKind::kPhong;
  material.color = Rgbf::Constant(glossy);
  material.diffuse = Rgbf::Constant(diffuse);
  material.exponent = exponent;
  return material;
}

std::vector<Named> materials() {
  return {{"diffuse", material_from_text("diffuse:0.7")},
          {"ggx .35", material_from_text("ggx:0.35")},
          {"ggx .5", material_from_text("ggx:0.5")},
          {"ggx 1", material_from_text("ggx:1")},
          {"phong 1", phong(1, 0, 1)},
          {"phong 40", phong(0.3f, 0.6f, 40)},
          {"metal", metallic_rough({0.9f, 0.6f, 0.3f}, 1, 0.4f)},
          {"plastic", metallic_rough({0.2f, 0.5f, 0.8f}, 0, 0.35f)},
          {"half metal", metallic_rough(Rgbf::Ones(), 0.5f, 0.7f)}};
}

const float kViews[] = {0.05f, 0.3f, 0.75f, 1};

Vec3f view_of(float cosine) {
  return {std::sqrt(1 - cosine * cosine) * 0.6f, std::sqrt(1 - cosine * cosine) * 0.8f, cosine};
}

// The sphere in cells of equal solid angle.
constexpr int kHeights = 24, kTurns = 24;

int cell_of(const Vec3f& dir) {
  const int height = std::clamp(static_cast<int>((dir.z() + 1) / 2 * kHeights), 0, kHeights - 1);
  const double turn = std::atan2(dir.y(), dir.x()) / (2 * kPi) + 0.5;
  return height * kTurns + std::clamp(static_cast<int>(turn * kTurns), 0, kTurns - 1);
}

// Integral of `f` over each cell, by midpoints.
template <class F>
std::vector<double> integrals(const F& f, int steps) {
  std::vector<double> result(kHeights * kTurns, 0);
  const double solid_angle = 4 * kPi / (kHeights * kTurns * steps * steps);
  for (int h = 0; h < kHeights * steps; ++h) {
    const double z = 2 * (h + 0.5) / (kHeights * steps) - 1, r = std::sqrt(1 - z * z);
    for (int t = 0; t < kTurns * steps; ++t) {
      const double phi = ((t + 0.5) / (kTurns * steps) - 0.5) * 2 * kPi;
      const Vec3f dir = Vec3(r * std::cos(phi), r * std::sin(phi), z).cast<float>();
      result[static_cast<std::size_t>(h / steps * kTurns + t / steps)] += f(dir) * solid_angle;
    }
  }
  return result;
}

// Pearson's test: cells are joined until they expect twenty samples; five sigma of chi-square would be one run in a
// million.
TEST(Bsdf, SamplersDrawWhatTheDensitySays) {
  const Vec3f normal(0, 0, 1);
  constexpr int kSamples = 60000;
  for (const Named& each : materials()) {
    for (const float cosine : kViews) {
      const Bsdf bsdf(each.material, normal, view_of(cosine));
      const std::vector<double> expected = integrals([&](const Vec3f& dir) { return bsdf.pdf(dir); }, 24);
      std::vector<int> drawn(expected.size(), 0);
      int below = 0;
      Random random(7, 1);
      for (int k = 0; k < kSamples; ++k) {
        const Vec3f dir = bsdf.sample({random.uniform(), random.uniform()});
        ASSERT_NEAR(dir.norm(), 1, 1e-5f);
        if (dir.z() <= 0) {
          ++below;
        } else {
          ++drawn[static_cast<std::size_t>(cell_of(dir))];
        }
      }
      double all = 0, chi2 = 0, wait_expected = 0, wait_drawn = 0;
      int cells = 0;
      for (std::size_t k = 0; k < expected.size(); ++k) {
        all += expected[k];
        wait_expected += kSamples * expected[k];
        wait_drawn += drawn[k];
        if (wait_expected < 20) continue;
        chi2 += (wait_drawn - wait_expected) * (wait_drawn - wait_expected) / wait_expected;
        ++cells;
        wait_expected = wait_drawn = 0;
      }
      EXPECT_LT(chi2, cells + 5 * std::sqrt(2.0 * cells)) << each.name << " at " << cosine << ", " << cells << " cells";
      EXPECT_NEAR(all + static_cast<double>(below) / kSamples, 1, 0.012) << each.name << " at " << cosine;
    }
  }
}

// The albedo towards a viewer by the sampler, and its standard error.
struct Albedo {
  double mean = 0, error = 0, largest_weight = 0;
};

Albedo albedo_of(const Material& material, float cosine, int samples = 40000) {
  const Bsdf bsdf(material, {0, 0, 1}, view_of(cosine));
  Random random(11, 5);
  double sum = 0, squares = 0;
  Albedo albedo;
  for (int k = 0; k < samples; ++k) {
    const Vec3f dir = bsdf.sample({random.uniform(), random.uniform()});
    const float pdf = bsdf.pdf(dir);
    const double weight = pdf > 0 ? static_cast<double>(bsdf.value_times_cosine(dir)[1]) / pdf : 0;
    sum += weight;
    squares += weight * weight;
    albedo.largest_weight = std::max(albedo.largest_weight, weight);
  }
  albedo.mean = sum / samples;
  albedo.error = std::sqrt(std::max(0.0, squares / samples - albedo.mean * albedo.mean) / samples);
  return albedo;
}

TEST(Bsdf, ValueAndDensityBelongTogether) {
  for (const Named& each : materials()) {
    for (const float cosine : kViews) {
      const Bsdf bsdf(each.material, {0, 0, 1}, view_of(cosine));
      double integral = 0;
      for (const double part : integrals([&](const Vec3f& dir) { return bsdf.value_times_cosine(dir)[1]; }, 24))
        integral += part;
      const Albedo albedo = albedo_of(each.material, cosine);
      EXPECT_NEAR(albedo.mean, integral, 4 * albedo.error + 0.012 * integral) << each.name << " at " << cosine;
      EXPECT_LE(albedo.mean, 1 + 4 * albedo.error) << each.name << " at " << cosine << ": light from nowhere";
      EXPECT_LT(albedo.largest_weight, 4) << each.name << " at " << cosine << ": a sampler that misses its lobe";
    }
  }
}

// White furnace. GGX and glTF's material give back all that they get, from every side and at every roughness; the
// table's own error is the tolerance. Phong's lobe is cut by the horizon: it does so head-on.
TEST(Bsdf, WhiteIsWhite) {
  for (const float roughness : {0.0f, 0.03f, 0.1f, 0.2f, 0.37f, 0.5f, 0.71f, 0.9f, 1.0f}) {
    for (const float cosine : {0.03f, 0.1f, 0.3f, 0.6f, 0.85f, 1.0f}) {
      Material ggx{MaterialKind::kGgx, Rgbf::Ones(), roughness};
      for (const Material& material :
           {ggx, metallic_rough(Rgbf::Ones(), 0, roughness), metallic_rough(Rgbf::Ones(), 0.4f, roughness),
            metallic_rough(Rgbf::Ones(), 1, roughness)}) {
        const Albedo albedo = albedo_of(material, cosine, 20000);
        // Where the view grazes, the albedo of a smooth surface bends faster than the table follows.
        const double table = cosine < 0.2f ? 0.02 : 0.003;
        EXPECT_NEAR(albedo.mean, 1, 4 * albedo.error + table)
            << "roughness " << roughness << ", metallic " << material.metallic << ", cosine " << cosine;
      }
    }
  }
  for (const float exponent : {0.0f, 1.0f, 20.0f, 1000.0f}) {
    for (const float diffuse : {0.0f, 0.4f}) {
      const Albedo albedo = albedo_of(phong(1 - diffuse, diffuse, exponent), 1);
      EXPECT_NEAR(albedo.mean, 1, 3 * albedo.error + 1e-4) << exponent;
    }
  }
}

// At alpha = 1, D = 1 / pi and G2 = 2 c / (1 + c): head-on the integral of D G2 / 4 is 1 - ln 2.
TEST(Bsdf, OneBounceOfTheRoughestGgxIsOneMinusLogTwo) {
  const GgxAlbedo albedo = ggx_albedo(1, 1);
  EXPECT_NEAR(albedo.scale + albedo.bias, 1 - std::log(2.0), 0.001);
  const GgxAlbedo smooth = ggx_albedo(0.7f, 0);
  EXPECT_NEAR(smooth.scale + smooth.bias, 1, 0.001);
  EXPECT_NEAR(smooth.bias, std::pow(0.3, 5), 0.001) << "Schlick's term at the mirror direction";
}

TEST(Bsdf, LobesLookWhereTheyShould) {
  // A sharp lobe has its peak in the mirror direction, in Phong's as in GGX's.
  const Vec3f wo = view_of(0.6f), mirrored(-wo.x(), -wo.y(), wo.z());
  for (const Material& material :
       {phong(1, 0, 500), material_from_text("ggx:0.1"), metallic_rough(Rgbf::Ones(), 1, 0.1f)}) {
    const Bsdf bsdf(material, {0, 0, 1}, wo);
    const float peak = bsdf.value_times_cosine(mirrored)[1];
    for (const Vec3f& off : {Vec3f(0.2f, 0, 0), Vec3f(-0.2f, 0, 0), Vec3f(0, 0.2f, 0), Vec3f(0, -0.2f, 0)})
      EXPECT_LT(bsdf.value_times_cosine((mirrored + off).normalized())[1], 0.5f * peak);
  }
  // A metal tints its gloss, plastic does not.
  const Rgbf red(0.9f, 0.1f, 0.1f);
  const Rgbf metal = Bsdf(metallic_rough(red, 1, 0.3f), {0, 0, 1}, wo).value_times_cosine(mirrored);
  EXPECT_GT(metal[0], 3 * metal[2]);
  const Bsdf plastic(metallic_rough(red, 0, 0.1f), {0, 0, 1}, wo);
  const Rgbf gloss = plastic.value_times_cosine(mirrored) - plastic.value_times_cosine(Vec3f(0, 0, 1)) * mirrored.z();
  EXPECT_NEAR(gloss[0] / gloss[2], 1, 0.02);
}

}  // namespace
}  // namespace hdr
