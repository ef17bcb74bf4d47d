#pragma once
// Light that surfaces which are not diffuse send to their viewer: directions from the probe and from the surface's own
// lobe, by the balance heuristic [Veach95]. Every method shares it.
#include "libhdr/render/internal/bsdf.h"
#include "libhdr/render/internal/direction_pool.h"
#include "libhdr/render/internal/integrator.h"

namespace hdr {

class Gloss {
 public:
  /// `share_of_probe` of the directions are drawn from the probe: 0, 1 or between.
  Gloss(const Setting& setting, double share_of_probe);

  void begin(const Pass& pass);
  /// Adds to `out` an estimate of the radiance that leaves each glossy surface; as Integrator::irradiance().
  void radiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const;

 private:
  class Batch;
  void from_probe(const Surfaces& at, const Pass& pass, const std::vector<Bsdf>& surfaces, Batch& batch) const;
  void from_surfaces(const Surfaces& at, const Pass& pass, const std::vector<Bsdf>& surfaces, Batch& batch) const;

  const Scene& scene_;
  Visibility visibility_;
  const Environment& light_;
  double share_;
  DirectionPool probe_pool_, surface_pool_;
};

}  // namespace hdr
