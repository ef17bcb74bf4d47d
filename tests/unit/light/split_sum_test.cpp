// The split sum's table: what is known in closed form, a sum that shares nothing with it, and a published fit.
#include <gtest/gtest.h>

#include "libhdr/light/prefilter.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

// The reflection integral itself, over directions l of the hemisphere by a midpoint rule: F D G2 / (4 n.v), alpha large
// enough for its steps.
SplitSum over_directions(double cos_v, double roughness, int steps) {
  const double alpha2 = std::pow(roughness, 4), sin_v = std::sqrt(1 - cos_v * cos_v);
  const auto lambda = [&](double c) { return 0.5 * (std::sqrt(1 + alpha2 * (1 - c * c) / (c * c)) - 1); };
  SplitSum sum;
  for (int i = 0; i < steps; ++i) {
    const double theta = 0.5 * kPi * (i + 0.5) / steps, cos_l = std::cos(theta), sin_l = std::sin(theta);
    for (int j = 0; j < steps; ++j) {
      const double phi = kPi * (j + 0.5) / steps;  // the other half is its mirror image
      const Vec3 v(sin_v, 0, cos_v), l(sin_l * std::cos(phi), sin_l * std::sin(phi), cos_l);
      const Vec3 h = (v + l).normalized();
      const double t = h.z() * h.z() * (alpha2 - 1) + 1, density = alpha2 / (kPi * t * t);
      const double g2 = 1 / (1 + lambda(cos_v) + lambda(cos_l));
      const double value = 2 * density * g2 / (4 * cos_v) * sin_l * (0.5 * kPi / steps) * (kPi / steps);
      const double w = std::pow(1 - v.dot(h), 5);
      sum.scale += value * (1 - w);
      sum.bias += value * w;
    }
  }
  return sum;
}

TEST(SplitSum, EqualsTheIntegralOverDirections) {
  for (const double roughness : {0.4, 0.6, 0.8, 1.0}) {
    for (const double cos_v : {0.1, 0.3, 0.6, 0.9, 1.0}) {
      const SplitSum fast = split_sum(cos_v, roughness), slow = over_directions(cos_v, roughness, 500);
      EXPECT_NEAR(fast.scale, slow.scale, 1e-4) << roughness << " " << cos_v;
      EXPECT_NEAR(fast.bias, slow.bias, 1e-4) << roughness << " " << cos_v;
    }
  }
}

// alpha = 1: D = 1 / pi and G2 = 2 (n.l) (n.v) / (n.l + n.v), so that a white surface returns
// integral of c / (c + n.v) dc = 1 - n.v ln(1 + 1 / n.v); 1 - ln 2 seen head-on.
TEST(SplitSum, RoughnessOneIsKnownInClosedForm) {
  for (const double cos_v : {0.004, 0.02, 0.1, 0.25, 0.5, 0.75, 1.0}) {
    const SplitSum sum = split_sum(cos_v, 1);
    EXPECT_NEAR(sum.scale + sum.bias, 1 - cos_v * std::log(1 + 1 / cos_v), 2e-5) << cos_v;
  }
}

struct Pinned {
  double cos_v, roughness, scale, bias;
};

// Converged (400 x 400 nodes agree with 300 x 300 to 1e-13).
TEST(SplitSum, PinnedValues) {
  for (const Pinned& p : {Pinned{0.02, 0.05, 0.1005467, 0.8901763}, Pinned{0.1, 0.05, 0.4101278, 0.5895436},
                          Pinned{0.5, 0.05, 0.9687192, 0.0312651},  Pinned{0.9, 0.05, 0.9999828, 0.0000101},
                          Pinned{0.02, 0.2, 0.3474748, 0.5702786},  Pinned{0.1, 0.2, 0.4593286, 0.4696647},
                          Pinned{0.5, 0.2, 0.9631846, 0.0322720},   Pinned{0.9, 0.2, 0.9980485, 0.0000344},
                          Pinned{0.02, 0.4, 0.6967924, 0.2690453},  Pinned{0.1, 0.4, 0.6756402, 0.2126775},
                          Pinned{0.5, 0.4, 0.8975047, 0.0289329},   Pinned{0.9, 0.4, 0.9633454, 0.0002275},
                          Pinned{0.02, 0.6, 0.8401391, 0.1237340},  Pinned{0.1, 0.6, 0.7896688, 0.0927388},
                          Pinned{0.5, 0.6, 0.7664759, 0.0156473},   Pinned{0.9, 0.6, 0.8141568, 0.0004022},
                          Pinned{0.02, 0.8, 0.8820539, 0.0643813},  Pinned{0.1, 0.8, 0.7888570, 0.0442012},
                          Pinned{0.5, 0.8, 0.6143462, 0.0068727},   Pinned{0.9, 0.8, 0.5608342, 0.0003112},
                          Pinned{0.02, 1, 0.8819250, 0.0394384},    Pinned{0.1, 1, 0.7363436, 0.0238669},
                          Pinned{0.5, 1, 0.4477051, 0.0029887},     Pinned{0.9, 1, 0.3273410, 0.0001660}}) {
    const SplitSum sum = split_sum(p.cos_v, p.roughness);
    EXPECT_NEAR(sum.scale, p.scale, 2e-5) << p.cos_v << " " << p.roughness;
    EXPECT_NEAR(sum.bias, p.bias, 2e-5) << p.cos_v << " " << p.roughness;
  }
}

TEST(SplitSum, AMirrorReturnsItsFresnelExactlyAndIsApproachedSmoothly) {
  for (const double cos_v : {0.05, 0.3, 0.7, 1.0}) {
    const double fresnel = std::pow(1 - cos_v, 5);
    EXPECT_EQ(split_sum(cos_v, 0).scale, 1 - fresnel);
    EXPECT_EQ(split_sum(cos_v, 0).bias, fresnel);
    EXPECT_NEAR(split_sum(cos_v, 0.01).scale, 1 - fresnel, 2e-5);
    EXPECT_NEAR(split_sum(cos_v, 0.01).bias, fresnel, 2e-5);
  }
}

TEST(SplitSum, NoLightOutOfNothing) {
  const Image<float> table = split_sum_table(64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      EXPECT_GE(table(x, y, 0), 0);
      EXPECT_GE(table(x, y, 1), 0);
      EXPECT_LE(table(x, y, 0) + table(x, y, 1), 1) << x << " " << y;
    }
  }
}

// Of the table that three.js publishes (r181: 16 x 16 halves, 4096 samples a texel; the same law).
TEST(SplitSum, AgreesWithAPublishedTable) {
  for (const Pinned& p : {Pinned{0.03125, 0.03125, 0.14709, 0.8521}, Pinned{0.15625, 0.65625, 0.77197, 0.05994},
                          Pinned{0.28125, 0.28125, 0.79297, 0.1587}, Pinned{0.53125, 0.53125, 0.82178, 0.01651},
                          Pinned{0.53125, 0.78125, 0.62402, 0.006279}, Pinned{0.84375, 0.53125, 0.87549, 0.0008769},
                          Pinned{0.96875, 0.96875, 0.34521, 7.051e-05}}) {
    const SplitSum sum = split_sum(p.cos_v, p.roughness);
    EXPECT_NEAR(sum.scale, p.scale, 1.5e-3) << p.cos_v << " " << p.roughness;
    EXPECT_NEAR(sum.bias, p.bias, 1.5e-3) << p.cos_v << " " << p.roughness;
  }
}

}  // namespace
}  // namespace hdr
