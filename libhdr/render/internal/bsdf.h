#pragma once
// How a surface scatters: value, sampler and density of diffuse and GGX materials, for one viewer.
#include "libhdr/core/vec.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// wo and wi point away from the surface. GGX scatters once: light that bounces between microfacets is lost, so a white
/// one returns less than it receives: seen head-on at roughness 1, 1 - ln 2 = 31 % of it.
class Bsdf {
 public:
  Bsdf(const Material& material, const Vec3f& normal, const Vec3f& wo);

  /// f(wo, wi) (n.wi); 0 below the horizon.
  Rgbf value_times_cosine(const Vec3f& wi) const;

  /// Cosine-weighted for diffuse, by visible normals for GGX [Heitz18]. May lie below the horizon: then its pdf is 0.
  Vec3f sample(const Vec2& u) const;

  /// Density of sample(), per steradian.
  float pdf(const Vec3f& wi) const;

 private:
  Vec3f to_local(const Vec3f& w) const { return {w.dot(tangent_), w.dot(bitangent_), w.dot(normal_)}; }
  Vec3f to_world(const Vec3f& w) const { return w.x() * tangent_ + w.y() * bitangent_ + w.z() * normal_; }
  float distribution(const Vec3f& h) const;
  float lambda(const Vec3f& w) const;
  Vec3f sample_visible_normal(const Vec2& u) const;

  const Material& material_;
  Vec3f normal_, tangent_, bitangent_;
  Vec3f wo_;  ///< in the local frame, normal = z
  float alpha_;
};

}  // namespace hdr
