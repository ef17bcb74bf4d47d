#pragma once
// Rays against triangles, on Embree. Its headers stay in tracer.cpp.
#include <memory>
#include <optional>

#include "libhdr/core/vec.h"
#include "libhdr/render/scene.h"

namespace hdr {

struct Hit {
  Vec3f position;   ///< lifted off the surface along the geometric normal, so that rays from it do not meet it again
  Vec3f geometric;  ///< unit, on the side the ray came from
  Vec3f normal;     ///< shading normal, unit, same side
  const Material* material = nullptr;
};

class Tracer {
 public:
  explicit Tracer(const Scene& scene);  ///< builds the hierarchy; `scene` must outlive it
  ~Tracer();
  Tracer(Tracer&&) noexcept;

  std::optional<Hit> intersect(const Vec3f& origin, const Vec3f& dir) const;
  bool occluded(const Vec3f& origin, const Vec3f& dir) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hdr
