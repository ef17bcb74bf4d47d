#include "libhdr/render/internal/bsdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libhdr/core/color.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/ggx.h"

namespace hdr {
namespace {

constexpr float kPif = std::numbers::pi_v<float>;

// Density cos(theta) / pi: a uniform disc, lifted. The lecture's theta = asin(sqrt(u)), phi = 2 pi v.
Vec3f cosine_weighted(const Vec2& u) {
  const auto r = static_cast<float>(std::sqrt(u.x()));
  const auto phi = static_cast<float>(2 * kPi * u.y());
  return {r * std::cos(phi), r * std::sin(phi), static_cast<float>(std::sqrt(1 - u.x()))};
}

float luminance_of(const Rgbf& rgb) {
  return luminance(rgb[0], rgb[1], rgb[2]);
}

}  // namespace

Bsdf::Bsdf(const Material& material, const Vec3f& normal, const Vec3f& wo)
    : kind_(material.kind), normal_(normal), diffuse_(Rgbf::Zero()), glossy_(Rgbf::Zero()), edge_(Rgbf::Zero()) {
  HDR_ASSERT(kind_ != MaterialKind::kMirror);
  tangents_from_normal(normal_, tangent_, bitangent_);
  wo_ = to_local(wo);
  if (kind_ == MaterialKind::kDiffuse) {
    diffuse_ = material.color;
    return;
  }
  Rgbf glossy_albedo = material.color;
  if (kind_ == MaterialKind::kPhong) {
    glossy_ = material.color;
    exponent_ = material.exponent;
    diffuse_ = material.diffuse;
  } else {
    glossy_albedo = prepare_ggx(material);
  }
  const float from_glossy = luminance_of(glossy_albedo), sum = from_glossy + luminance_of(diffuse_);
  glossy_share_ = sum > 0 ? from_glossy / sum : 1;
}

// Returns the lobe's albedo towards the viewer. [glTF2]: F0 is .04 (an index of 1.5) for dielectrics and the base
// colour for metals; what is between is a mixture of both.
Rgbf Bsdf::prepare_ggx(const Material& material) {
  constexpr float kDielectric = 0.04f;
  alpha_ = ggx_alpha(material.roughness);
  const GgxAlbedo once = ggx_albedo(wo_.z(), material.roughness);
  const float lost = 1 - once.scale - once.bias;
  const auto albedo_of = [&](const Rgbf& f0, const Rgbf& gain) { return Rgbf(gain * (f0 * once.scale + once.bias)); };
  const auto gain_of = [&](const Rgbf& f0) { return Rgbf(1 + f0 * (lost / (1 - lost))); };
  const float metallic = kind_ == MaterialKind::kGgx ? 1 : material.metallic;
  const Rgbf plain = Rgbf::Constant(kDielectric), metal_gain = gain_of(material.color), plain_gain = gain_of(plain);
  const Rgbf plain_albedo = albedo_of(plain, plain_gain);
  glossy_ = metallic * metal_gain * material.color + (1 - metallic) * plain_gain * plain;
  edge_ = metallic * metal_gain + (1 - metallic) * plain_gain;
  diffuse_ = (1 - metallic) * material.color * (1 - plain_albedo).max(0.0f);
  return metallic * albedo_of(material.color, metal_gain) + (1 - metallic) * plain_albedo;
}

// GGX: f = D F G2 / (4 n.wo n.wi). Phong: f = (n + 2) / (2 pi) cos^n [Lafortune94] eq. 2.
Rgbf Bsdf::glossy_value(const Vec3f& wi) const {
  if (kind_ == MaterialKind::kPhong) {
    const float cosine = std::max(0.0f, Vec3f(-wo_.x(), -wo_.y(), wo_.z()).dot(wi));
    return glossy_ * ((exponent_ + 2) / (2 * kPif) * std::pow(cosine, exponent_) * wi.z());
  }
  const Vec3f h = (wo_ + wi).normalized();
  const float g2 = 1 / (1 + ggx_lambda(wo_, alpha_) + ggx_lambda(wi, alpha_));
  const float m = std::clamp(1 - wo_.dot(h), 0.0f, 1.0f), schlick = m * m * m * m * m;  // [Schlick94]
  return (glossy_ + schlick * (edge_ - glossy_)) * (ggx_distribution(h, alpha_) * g2 / (4 * wo_.z()));
}

Rgbf Bsdf::value_times_cosine(const Vec3f& world_wi) const {
  const Vec3f wi = to_local(world_wi);
  if (wi.z() <= 0 || wo_.z() <= 0) return Rgbf::Zero();
  const Rgbf matte = diffuse_ * (wi.z() / kPif);
  return kind_ == MaterialKind::kDiffuse ? matte : Rgbf(matte + glossy_value(wi));
}

Vec3f Bsdf::glossy_sample(const Vec2& u) const {
  if (kind_ != MaterialKind::kPhong) {
    const Vec3f h = ggx_visible_normal(wo_, alpha_, u);
    return (2 * wo_.dot(h) * h - wo_).normalized();
  }
  const auto cosine = static_cast<float>(std::pow(u.x(), 1 / (exponent_ + 1.0)));
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  const auto phi = static_cast<float>(2 * kPi * u.y());
  const Vec3f mirrored(-wo_.x(), -wo_.y(), wo_.z());
  Vec3f t, b;
  tangents_from_normal(mirrored, t, b);
  return (sine * std::cos(phi) * t + sine * std::sin(phi) * b + cosine * mirrored).normalized();
}

// One lobe is drawn by the first number, whose rest is uniform again.
Vec3f Bsdf::sample(const Vec2& u) const {
  const double share = glossy_share_;
  if (u.x() >= share)
    return to_world(cosine_weighted({share > 0 ? std::min((u.x() - share) / (1 - share), 1.0) : u.x(), u.y()}));
  return to_world(glossy_sample({share < 1 ? u.x() / share : u.x(), u.y()}));
}

// GGX: G1(wo) D(h) / (4 n.wo), the density of visible normals [Heitz18] eq. 3, by the Jacobian of a reflection.
// Phong: (n + 1) / (2 pi) cos^n.
float Bsdf::glossy_pdf(const Vec3f& wi) const {
  if (kind_ == MaterialKind::kPhong) {
    const float cosine = std::max(0.0f, Vec3f(-wo_.x(), -wo_.y(), wo_.z()).dot(wi));
    return (exponent_ + 1) / (2 * kPif) * std::pow(cosine, exponent_);
  }
  const Vec3f h = (wo_ + wi).normalized();
  return ggx_distribution(h, alpha_) / ((1 + ggx_lambda(wo_, alpha_)) * 4 * wo_.z());
}

float Bsdf::pdf(const Vec3f& world_wi) const {
  const Vec3f wi = to_local(world_wi);
  if (wi.z() <= 0 || wo_.z() <= 0) return 0;
  const float matte = (1 - glossy_share_) * (wi.z() / kPif);
  return glossy_share_ > 0 ? matte + glossy_share_ * glossy_pdf(wi) : matte;
}

}  // namespace hdr
