#pragma once
// Rays against triangles, on Embree. Its headers stay in tracer.cpp.
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

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

/// Rays side by side, for packets: neighbours should look the same way. Directions of any length but 0.
struct RayArrays {
  const float *origin_x, *origin_y, *origin_z;
  const float *dir_x, *dir_y, *dir_z;
};

/// How far apart the directions of rays are that are traced together: a beam's all point one way, within a degree.
enum class Spread { kBeam, kWide };

class Tracer {
 public:
  /// How long the hierarchy may take to build: a few rays do not repay a good one.
  enum class Effort { kFewRays, kManyRays };

  explicit Tracer(const Scene& scene, Effort effort = Effort::kManyRays);  ///< `scene` must outlive it
  ~Tracer();
  Tracer(Tracer&&) noexcept;

  std::optional<Hit> intersect(const Vec3f& origin, const Vec3f& dir) const;
  bool occluded(const Vec3f& origin, const Vec3f& dir) const;

  static constexpr int kPacket = 16;

  /// The first hits of rays that start together, as many as `hits`; the arrays hold whole packets.
  void intersect(const RayArrays& rays, std::span<std::optional<Hit>> hits, Spread spread = Spread::kBeam) const;

  /// How far rays with directions of length 1 go; infinity where they meet nothing.
  void distances(const RayArrays& rays, std::span<float> far, Spread spread) const;

  /// `wanted` is -1 where a ray is to be traced and 0 elsewhere; it stays -1 where nothing is in the way. Whole
  /// packets: wanted.size() is a multiple of kPacket. Returns the number of rays traced.
  int visible(const RayArrays& rays, std::span<std::int32_t> wanted, Spread spread = Spread::kWide) const;

  /// The whole scene lies behind the plane of each of its triangles: no ray that leaves a front meets anything.
  bool convex() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hdr
