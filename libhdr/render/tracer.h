#pragma once
// Rays against triangles, on Embree. Its headers stay in tracer.cpp.
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "libhdr/core/vec.h"
#include "libhdr/render/scene.h"

namespace hdr {

struct Hit {
  Vec3f position;   ///< lifted to the smooth surface that the triangles stand for: rays into the hemisphere of `normal`
                    ///< do not meet the triangle that they leave
  Vec3f geometric;  ///< unit, on the side the ray came from
  Vec3f normal;     ///< shading normal, unit, same side
  bool front = true;  ///< the ray came from the side that the triangle's winding calls outside
  const Material* material = nullptr;
  std::uint32_t mesh = 0, triangle = 0;  ///< where in the scene
  std::array<float, 3> weights{};        ///< of the triangle's corners
};

class Tracer {
 public:
  explicit Tracer(const Scene& scene);  ///< builds the hierarchy; `scene` must outlive it
  ~Tracer();
  Tracer(Tracer&&) noexcept;

  std::optional<Hit> intersect(const Vec3f& origin, const Vec3f& dir) const;
  bool occluded(const Vec3f& origin, const Vec3f& dir) const;

  /// The whole scene lies behind the plane of each of its triangles: no ray that leaves a front meets anything.
  bool convex() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hdr
