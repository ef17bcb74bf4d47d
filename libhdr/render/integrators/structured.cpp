// Structured importance sampling [Agarwal03]: the probe cut into strata, one shadow ray to each. Directions are drawn
// by luminance inside the stratum, for every pixel and pass anew: no bias and no floor, whatever the number of strata.
#include <map>

#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/light_strata.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/internal/rows.h"

namespace hdr {
namespace {

class Structured : public Integrator {
 public:
  using Cut = LightStrata (*)(View<const float> latlong, int count);
  Structured(const Setting& setting, Cut cut)
      : visibility_(setting.tracer, setting.convex), map_(setting.light.latlong()), cut_(cut) {}

  void begin(const Pass& pass) override {
    auto [strata, made] = strata_.try_emplace(pass.directions, nullptr);
    if (made) strata->second = std::make_unique<LightStrata>(cut_(map_, pass.directions));
    pool_ = stratified_light(*strata->second, address(pass.seed, static_cast<std::uint64_t>(pass.index), 0, 2));
  }

  void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const override {
    Rays towards(at.places);
    for (int row = 0; row < pool_.rows; ++row) {
      const int camera_ray = pass.camera_ray_of(row);
      const std::size_t begin = pool_.begin(row, at.tile);
      if (!towards.face(pool_, begin, at, camera_ray)) continue;
      towards.keep_visible(visibility_, at, camera_ray, pool_.spread(row, at.tile), rays);
      towards.add(pool_, begin, camera_ray, static_cast<float>(pass.camera_rays), out);
    }
  }

 private:
  Visibility visibility_;
  View<const float> map_;
  Cut cut_;
  std::map<int, std::unique_ptr<LightStrata>> strata_;  ///< by their number
  DirectionPool pool_;
};

}  // namespace

std::unique_ptr<Integrator> make_structured(const Setting& setting) {
  return std::make_unique<Structured>(setting, &LightStrata::structured);
}

// The lecture's second view of the integral: every pixel of the probe a directional light. A pass takes a subset that
// covers the map evenly, each pixel with the light of the cell that it was drawn from; with as many directions as
// pixels, all.
std::unique_ptr<Integrator> make_pixels(const Setting& setting) {
  return std::make_unique<Structured>(setting, &LightStrata::grid);
}

}  // namespace hdr
