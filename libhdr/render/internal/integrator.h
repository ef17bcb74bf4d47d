#pragma once
// Light along a ray: what the probe sends to the surface that the ray meets, and from there to the viewer.
#include <array>
#include <cstdint>

#include "libhdr/light/environment.h"
#include "libhdr/render/internal/bsdf.h"
#include "libhdr/render/render.h"
#include "libhdr/render/tracer.h"

namespace hdr {

class Integrator {
 public:
  /// `method` is none of kAuto. What it is given must outlive it.
  Integrator(const Scene& scene, const Environment& light, RenderMethod method, int directions);

  /// Of kPrt, before the first ray: lights the vertices.
  void relight(const std::vector<Transfer>& transfer);

  struct Seen {
    Rgb radiance = Rgb::Zero();
    bool hit = false;
  };
  /// Radiance that arrives along a camera ray, estimated with `directions` directions; `points` addresses their random
  /// numbers. Adds the rays traced to `rays`.
  Seen seen(const Vec3f& origin, const Vec3f& dir, std::uint64_t points, std::int64_t& rays) const;

  /// Nothing occludes anything: no shadow rays were or will be traced.
  bool skips_shadow_rays() const { return convex_; }

 private:
  Rgb lit(const Hit& hit, const Vec3f& wo, std::uint64_t points, std::int64_t& rays) const;
  Rgb smooth_irradiance(const Hit& hit) const;
  Rgb sampled(const Hit& hit, const Vec3f& wo, std::uint64_t points, std::int64_t& rays) const;
  bool visible(const Hit& hit, const Vec3f& dir, std::int64_t& rays) const;

  const Scene& scene_;
  Tracer tracer_;
  const Environment& light_;
  RenderMethod method_;
  int directions_;
  bool convex_;
  std::array<Mat4, 3> irradiance_{};                               ///< of kSh
  std::vector<Eigen::Matrix<float, Eigen::Dynamic, 3>> vertices_;  ///< of kPrt: irradiance, one matrix a mesh
};

}  // namespace hdr
