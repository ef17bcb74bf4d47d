#pragma once
// The GGX microfacet lobe in a frame whose z is the normal: distribution, shadowing, visible normals, albedo.
#include "libhdr/core/vec.h"

namespace hdr {

/// alpha = roughness^2, never so smooth that a float direction would no longer resolve the lobe: mirrors are a material
/// of their own.
float ggx_alpha(float roughness);

/// D(h) = 1 / (pi alpha^2 ((hx^2 + hy^2) / alpha^2 + hz^2)^2), [Heitz18] eq. 1 of an isotropic surface.
float ggx_distribution(const Vec3f& h, float alpha);

/// [Heitz18] eq. 2: Lambda = (-1 + sqrt(1 + alpha^2 tan^2 theta)) / 2. G1 = 1 / (1 + Lambda(wo)), and with heights
/// correlated G2 = 1 / (1 + Lambda(wo) + Lambda(wi)).
float ggx_lambda(const Vec3f& w, float alpha);

/// A microfacet normal with the density of those that `wo` sees, D(h) G1(wo) (h.wo) / n.wo. u in [0,1)^2.
Vec3f ggx_visible_normal(const Vec3f& wo, float alpha, const Vec2& u);

/// What one bounce between microfacets returns of a white sky to a viewer at this cosine, with Schlick's Fresnel term:
/// F0 `scale` + `bias` [Karis13]; their sum is the whole lobe's share. From a table made on first use, within .002.
struct GgxAlbedo {
  float scale = 1, bias = 0;
};
GgxAlbedo ggx_albedo(float cosine, float roughness);

}  // namespace hdr
