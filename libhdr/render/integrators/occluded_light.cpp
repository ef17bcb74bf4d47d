// Unshadowed irradiance times openness: a heuristic, not a method (the lecture says so too), but one that knows contact
// shadows and costs no more than ambient occlusion. With the light's mean instead of harmonics, E = pi mean(L) A: right
// under a constant probe.
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/integrator.h"

namespace hdr {
namespace {

class OccludedLight : public Integrator {
 public:
  OccludedLight(const Setting& setting, bool harmonics) : openness_(make_ao(setting)) {
    if (harmonics) light_ = make_sh(setting);
    mean_ = (setting.light.total_power() / 4).cast<float>();  // pi times the mean over 4 pi
  }

  void begin(const Pass& pass) override { openness_->begin(pass); }

  int most_directions() const override { return openness_->most_directions(); }

  void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const override {
    openness_->irradiance(at, pass, out, rays);
    static thread_local Light light;
    light.reset(at.count());
    if (light_) light_->irradiance(at, pass, light, rays);
    for (std::size_t c = 0; c < 3; ++c) {
      const float mean = mean_[static_cast<int>(c)];
      for (std::size_t k = 0; k < out.rgb[c].size(); ++k) out.rgb[c][k] *= light_ ? light.rgb[c][k] : mean;
    }
  }

 private:
  std::unique_ptr<Integrator> openness_, light_;
  Rgbf mean_;
};

}  // namespace

std::unique_ptr<Integrator> make_occluded_sh(const Setting& setting) {
  return std::make_unique<OccludedLight>(setting, true);
}

std::unique_ptr<Integrator> make_occluded_mean(const Setting& setting) {
  return std::make_unique<OccludedLight>(setting, false);
}

}  // namespace hdr
