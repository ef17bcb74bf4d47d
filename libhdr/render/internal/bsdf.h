#pragma once
// How a surface scatters: value, sampler and density of its materials, for one viewer.
#include "libhdr/core/vec.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// wo and wi point away from the surface. Two lobes at most: a diffuse one, and a glossy one (GGX or Phong).
///
/// GGX scatters once; light that bounces between microfacets is given back by a factor, 1 + F0 (1 - E) / E with E the
/// share that one bounce returns [Turquin19]: a white surface is white at any roughness. kMetallicRough mixes a metal
/// and a dielectric, as [glTF2] says; of the dielectric the diffuse lobe has what the glossy one leaves, 1 - its albedo
/// towards the viewer: white is white here too.
class Bsdf {
 public:
  /// Any material but a mirror, without textures (material_at()); it must outlive the Bsdf no longer than this call.
  Bsdf(const Material& material, const Vec3f& normal, const Vec3f& wo);

  /// f(wo, wi) (n.wi); 0 below the horizon.
  Rgbf value_times_cosine(const Vec3f& wi) const;

  /// Cosine-weighted for diffuse, by visible normals for GGX [Heitz18], cos^n around the mirror direction for Phong
  /// [Lafortune94]; of two lobes one is drawn by its albedo. May lie below the horizon: then its pdf is 0.
  Vec3f sample(const Vec2& u) const;

  /// Density of sample(), per steradian.
  float pdf(const Vec3f& wi) const;

 private:
  Vec3f to_local(const Vec3f& w) const { return {w.dot(tangent_), w.dot(bitangent_), w.dot(normal_)}; }
  Vec3f to_world(const Vec3f& w) const { return w.x() * tangent_ + w.y() * bitangent_ + w.z() * normal_; }
  Rgbf prepare_ggx(const Material& material);
  Rgbf glossy_value(const Vec3f& wi) const;
  float glossy_pdf(const Vec3f& wi) const;
  Vec3f glossy_sample(const Vec2& u) const;

  MaterialKind kind_;
  Vec3f normal_, tangent_, bitangent_;
  Vec3f wo_;      ///< in the local frame, normal = z
  Rgbf diffuse_;  ///< albedo
  /// Schlick's F0 + (1 - F0) m^5, its gain included: glossy_ at normal incidence, edge_ at the horizon; of Phong
  /// glossy_.
  Rgbf glossy_, edge_;
  float alpha_ = 1;         ///< of GGX
  float exponent_ = 1;      ///< of Phong
  float glossy_share_ = 0;  ///< of the samples
};

}  // namespace hdr
