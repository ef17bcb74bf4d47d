#pragma once
// Rays side by side on their way through Embree. Private to tracer.cpp: Embree's headers are heavy.
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <span>

#include "libhdr/render/tracer.h"

namespace hdr {

/// As many rays as Embree takes at once, and what it wants to know of each. What tells nothing is the same for all.
class RayStream {
 public:
  static constexpr std::size_t kMost = 64;

  RayStream(RTCScene tree, Spread spread);

  /// Of `count` rays, from `first` on; `far` is where each may end, and becomes minus infinity where something is in
  /// the way. Rays that end before they begin are not traced.
  void occlude(const RayArrays& rays, std::size_t first, std::size_t count, float* far);

  struct Hits {
    alignas(64) std::array<unsigned, kMost> triangle, mesh, instance;  ///< mesh is RTC_INVALID_GEOMETRY_ID: none
    alignas(64) std::array<float, kMost> far, u, v, normal_x, normal_y, normal_z;
  };
  void intersect(const RayArrays& rays, std::size_t first, std::size_t count, Hits& hits);

 private:
  RTCRayNp stream_of(const RayArrays& rays, std::size_t first, float* far);

  RTCScene tree_;
  RTCIntersectContext context_;
};

/// Where `wanted` is -1, traces and puts 0 if something is in the way. Returns the number of rays.
int trace_occlusion(RTCScene tree, const RayArrays& rays, Spread spread, std::span<std::int32_t> wanted);

}  // namespace hdr
