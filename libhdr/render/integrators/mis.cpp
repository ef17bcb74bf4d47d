// Multiple importance sampling [Veach95]: some directions from the probe, some from the surface, all weighted by the
// balance heuristic: f / (n_p pdf_p + n_s pdf_s). With none from the surface it is importance sampling of the probe.
// Points are Owen-scrambled Sobol's; a probe that is sampled by what it has above its mean leaves the rest to the
// surface [Karlik19].
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/latlong_lookup.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/internal/rows.h"

namespace hdr {
namespace {

class Mis : public Integrator {
 public:
  Mis(const Setting& setting, double share)
      : visibility_(setting.tracer, setting.convex), light_(setting.light), share_(share) {}

  void begin(const Pass& pass) override {
    const ProbeShare shares = probe_share(pass, share_);
    const auto stream = [&](std::uint64_t use) {
      return address(pass.seed, static_cast<std::uint64_t>(pass.index), 0, use);
    };
    const RowOrder order = pass.rows_by_chance ? RowOrder::kByChance : RowOrder::kParts;
    from_probe_ = sobol_environment(light_, shares.of_probe, stream(2), order);
    from_surface_ = sobol_hemisphere(shares.of_surface, stream(3), order);
  }

  void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const override {
    if (light_.black()) return;
    Rays towards(at.places);
    // Each camera ray has its share of the rows, and stands for all: by so much more does each of them count.
    const auto probe_density = static_cast<float>(from_probe_.rows) / static_cast<float>(pass.camera_rays);
    const auto surface_density =
        static_cast<float>(from_surface_.rows) / static_cast<float>(pass.camera_rays) / static_cast<float>(kPi);
    for (int row = 0; row < from_probe_.rows; ++row) {
      const int camera_ray = pass.camera_ray_of(row);
      const std::size_t begin = from_probe_.begin(row, at.tile);
      if (!towards.face(from_probe_, begin, at, camera_ray)) continue;
      towards.keep_visible(visibility_, at, camera_ray, from_probe_.spread(row, at.tile), rays);
      towards.add_balanced(from_probe_, begin, camera_ray, {probe_density, surface_density}, out);
    }
    const View<const float> map = light_.latlong();
    const Environment::DensityLaw law = light_.density_law();
    std::vector<std::int32_t> pixels(static_cast<std::size_t>(at.places));
    for (int row = 0; row < from_surface_.rows; ++row) {
      const int camera_ray = pass.camera_ray_of(from_probe_.rows + row);
      const std::size_t begin = from_surface_.begin(row, at.tile);
      towards.turn(from_surface_, begin, at, camera_ray);
      towards.keep_visible(visibility_, at, camera_ray, Spread::kWide, rays);
      latlong_offsets(towards.x, towards.y, towards.z, at.places, map, pixels.data());
      const auto first = static_cast<std::size_t>(camera_ray * at.places);
      for (std::size_t k = 0; k < pixels.size(); ++k) {
        if (!towards.wanted[k]) continue;
        const float* p = map.data() + pixels[k];
        const float cosine = from_surface_.z[begin + k];
        const float weight = cosine / (probe_density * law.pdf(p) + surface_density * cosine);
        for (std::size_t c = 0; c < 3; ++c) out.rgb[c][first + k] += weight * p[c];
      }
    }
  }

 private:
  Visibility visibility_;
  const Environment& light_;
  double share_;
  DirectionPool from_probe_, from_surface_;
};

}  // namespace

ProbeShare probe_share(const Pass& pass, double share) {
  // The surface has at least one: it alone reaches everything.
  const int of_probe = std::min(static_cast<int>(share * pass.directions), pass.directions - (share < 1 ? 1 : 0));
  return {of_probe, pass.directions - of_probe};
}

std::unique_ptr<Integrator> make_mis(const Setting& setting, double share_of_probe) {
  return std::make_unique<Mis>(setting, share_of_probe);
}

}  // namespace hdr
