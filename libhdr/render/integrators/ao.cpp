// Ambient occlusion, eq. 18 of the lecture: the share of the hemisphere's rays that meet nothing. Rays are
// cosine-weighted, which is the occlusion that irradiance needs: E = pi L A under a constant L.
#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/internal/rows.h"

namespace hdr {
namespace {

class Ao : public Integrator {
 public:
  explicit Ao(const Setting& setting) : visibility_(setting.tracer, setting.convex) {}

  void begin(const Pass& pass) override {
    pool_ = stratified_hemisphere(pass.directions, address(pass.seed, static_cast<std::uint64_t>(pass.index), 0, 2));
  }

  void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const override {
    Rays towards(at.places);
    const float share = static_cast<float>(pass.camera_rays) / static_cast<float>(pool_.rows);
    std::vector<float>& open = out.rgb[0];
    for (int row = 0; row < pool_.rows; ++row) {
      const int camera_ray = pass.camera_ray_of(row);
      towards.turn(pool_, pool_.begin(row, at.tile), at, camera_ray);
      towards.keep_visible(visibility_, at, camera_ray, Spread::kWide, rays);
      float* to = open.data() + camera_ray * at.places;
      for (std::size_t k = 0; k < towards.wanted.size(); ++k) to[k] += towards.wanted[k] != 0 ? share : 0.0f;
    }
    out.rgb[1] = out.rgb[2] = open;
  }

  bool openness() const override { return true; }

 private:
  Visibility visibility_;
  DirectionPool pool_;
};

}  // namespace

std::unique_ptr<Integrator> make_ao(const Setting& setting) {
  if (setting.options.depth_maps > 0) return make_ao_of_depth_maps(setting);
  return std::make_unique<Ao>(setting);
}

}  // namespace hdr
