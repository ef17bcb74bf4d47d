#pragma once
// One direction for each place of one camera ray of a tile: a row of a pool, its rays, and what they bring.
#include <cstdint>
#include <vector>

#include "libhdr/render/internal/direction_pool.h"
#include "libhdr/render/internal/integrator.h"

namespace hdr {

struct Rays {
  explicit Rays(int places);

  /// Directions of a row in each surface's own frame -> x, y, z of the world; wanted wherever there is a diffuse
  /// surface. Here and below, `begin` is where the row's variants for this tile begin in the pool.
  void turn(const DirectionPool& pool, std::size_t begin, const Surfaces& at, int camera_ray);
  /// Directions of a row of the world; wanted where they are above the surface, and whether any is. `weight` is the
  /// cosine.
  bool face(const DirectionPool& pool, std::size_t begin, const Surfaces& at, int camera_ray);
  void keep_visible(const Visibility& visibility, const Surfaces& at, int camera_ray, Spread spread,
                    std::int64_t& traced);
  /// Adds weight times `scale` times the row's light wherever it is still wanted.
  void add(const DirectionPool& pool, std::size_t begin, int camera_ray, float scale, Light& out) const;
  /// The same, by the balance heuristic: weight / (probe_density pdf + surface_density weight).
  struct Densities {
    float probe, surface;
  };
  void add_balanced(const DirectionPool& pool, std::size_t begin, int camera_ray, const Densities& densities,
                    Light& out) const;

  int places;
  const float *x, *y, *z;  ///< of the world
  std::vector<float> weight;
  std::vector<std::int32_t> wanted;  ///< -1 or 0

 private:
  std::vector<float> turned_x_, turned_y_, turned_z_;
};

}  // namespace hdr
