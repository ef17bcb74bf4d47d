// Monte Carlo, eq. 9 of the lecture: directions of the hemisphere, cosine-weighted, one from each of M x N strata; each
// brings the light that it meets, E = pi / (M N) sum of L V.
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/latlong_lookup.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/internal/rows.h"

namespace hdr {
namespace {

class Mc : public Integrator {
 public:
  explicit Mc(const Setting& setting) : visibility_(setting.tracer, setting.convex), map_(setting.light.latlong()) {}

  void begin(const Pass& pass) override {
    pool_ = stratified_hemisphere(pass.directions, address(pass.seed, static_cast<std::uint64_t>(pass.index), 0, 2));
  }

  void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const override {
    Rays towards(at.places);
    std::vector<std::int32_t> pixels(static_cast<std::size_t>(at.places));
    const float weight =
        static_cast<float>(kPi) * static_cast<float>(pass.camera_rays) / static_cast<float>(pool_.rows);
    for (int row = 0; row < pool_.rows; ++row) {
      const int camera_ray = pass.camera_ray_of(row);
      towards.turn(pool_, pool_.begin(row, at.tile), at, camera_ray);
      towards.keep_visible(visibility_, at, camera_ray, Spread::kWide, rays);
      latlong_offsets(towards.x, towards.y, towards.z, at.places, map_, pixels.data());
      const auto first = static_cast<std::size_t>(camera_ray * at.places);
      for (std::size_t k = 0; k < pixels.size(); ++k) {
        if (!towards.wanted[k]) continue;
        const float* p = map_.data() + pixels[k];
        for (std::size_t c = 0; c < 3; ++c) out.rgb[c][first + k] += weight * p[c];
      }
    }
  }

 private:
  Visibility visibility_;
  View<const float> map_;
  DirectionPool pool_;
};

}  // namespace

std::unique_ptr<Integrator> make_mc(const Setting& setting) {
  return std::make_unique<Mc>(setting);
}

}  // namespace hdr
