#include "libhdr/render/internal/bsdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

constexpr float kPif = std::numbers::pi_v<float>;

// Density cos(theta) / pi: a uniform disc, lifted. The lecture's theta = asin(sqrt(u)), phi = 2 pi v.
Vec3f cosine_weighted(const Vec2& u) {
  const auto r = static_cast<float>(std::sqrt(u.x()));
  const auto phi = static_cast<float>(2 * kPi * u.y());
  return {r * std::cos(phi), r * std::sin(phi), static_cast<float>(std::sqrt(1 - u.x()))};
}

// [Schlick94]: F0 + (1 - F0) (1 - cos)^5.
Rgbf fresnel(const Rgbf& f0, float cosine) {
  const float m = std::clamp(1 - cosine, 0.0f, 1.0f);
  return f0 + (1 - f0) * (m * m * m * m * m);
}

}  // namespace

Bsdf::Bsdf(const Material& material, const Vec3f& normal, const Vec3f& wo) : material_(material), normal_(normal) {
  HDR_ASSERT(material.kind != MaterialKind::kMirror);
  tangents_from_normal(normal_, tangent_, bitangent_);
  wo_ = to_local(wo);
  // Smoother than this, a float direction no longer resolves the lobe: mirrors are a material of their own.
  alpha_ = std::max(material.roughness * material.roughness, 1e-3f);
}

// D(h) = 1 / (pi alpha^2 ((hx^2 + hy^2) / alpha^2 + hz^2)^2), [Heitz18] eq. 1 of an isotropic surface.
float Bsdf::distribution(const Vec3f& h) const {
  const float alpha2 = alpha_ * alpha_;
  const float t = (h.x() * h.x() + h.y() * h.y()) / alpha2 + h.z() * h.z();
  return 1 / (kPif * alpha2 * t * t);
}

// [Heitz18] eq. 2: Lambda = (-1 + sqrt(1 + alpha^2 tan^2 theta)) / 2. G1 = 1 / (1 + Lambda(wo)), and with heights
// correlated G2 = 1 / (1 + Lambda(wo) + Lambda(wi)).
float Bsdf::lambda(const Vec3f& w) const {
  const float tan2 = (w.x() * w.x() + w.y() * w.y()) / (w.z() * w.z());
  return 0.5f * (std::sqrt(1 + alpha_ * alpha_ * tan2) - 1);
}

// f = D F G2 / (4 n.wo n.wi).
Rgbf Bsdf::value_times_cosine(const Vec3f& world_wi) const {
  const Vec3f wi = to_local(world_wi);
  if (wi.z() <= 0 || wo_.z() <= 0) return Rgbf::Zero();
  if (material_.kind == MaterialKind::kDiffuse) return material_.color * (wi.z() / kPif);
  const Vec3f h = (wo_ + wi).normalized();
  const float g2 = 1 / (1 + lambda(wo_) + lambda(wi));
  return fresnel(material_.color, wo_.dot(h)) * (distribution(h) * g2 / (4 * wo_.z()));
}

// [Heitz18] section 4: stretch the view to the hemisphere configuration, sample the projected disc, unstretch.
Vec3f Bsdf::sample_visible_normal(const Vec2& u) const {
  const Vec3f view = Vec3f(alpha_ * wo_.x(), alpha_ * wo_.y(), wo_.z()).normalized();
  const float length2 = view.x() * view.x() + view.y() * view.y();
  const Vec3f t1 = length2 > 0 ? Vec3f(Vec3f(-view.y(), view.x(), 0) / std::sqrt(length2)) : Vec3f(1, 0, 0);
  const Vec3f t2 = view.cross(t1);
  const auto r = static_cast<float>(std::sqrt(u.x()));
  const auto phi = static_cast<float>(2 * kPi * u.y());
  const float p1 = r * std::cos(phi);
  const float s = 0.5f * (1 + view.z());
  const float p2 = (1 - s) * std::sqrt(std::max(0.0f, 1 - p1 * p1)) + s * r * std::sin(phi);
  const Vec3f n = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0f, 1 - p1 * p1 - p2 * p2)) * view;
  return Vec3f(alpha_ * n.x(), alpha_ * n.y(), std::max(1e-6f, n.z())).normalized();
}

Vec3f Bsdf::sample(const Vec2& u) const {
  if (material_.kind == MaterialKind::kDiffuse) return to_world(cosine_weighted(u));
  const Vec3f h = sample_visible_normal(u);
  return to_world(2 * wo_.dot(h) * h - wo_).normalized();
}

// pdf = G1(wo) D(h) / (4 n.wo): the density of visible normals, [Heitz18] eq. 3, by the Jacobian of a reflection.
float Bsdf::pdf(const Vec3f& world_wi) const {
  const Vec3f wi = to_local(world_wi);
  if (wi.z() <= 0 || wo_.z() <= 0) return 0;
  if (material_.kind == MaterialKind::kDiffuse) return wi.z() / kPif;
  const Vec3f h = (wo_ + wi).normalized();
  return distribution(h) / ((1 + lambda(wo_)) * 4 * wo_.z());
}

}  // namespace hdr
