#include "libhdr/render/internal/gloss.h"

#include <algorithm>

#include "libhdr/render/internal/points.h"

namespace hdr {

// Rays that wait until there are enough for packets.
class Gloss::Batch {
 public:
  Batch(const Surfaces& at, const Visibility& visibility, Light& out, std::int64_t& traced)
      : at_(at), visibility_(visibility), out_(out), traced_(traced), wanted_(kRoom) {
    for (auto& array : arrays_) array.resize(kRoom);
    owners_.reserve(kRoom);
    brought_.reserve(kRoom);
  }
  ~Batch() { flush(); }
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  // `brings`: what is added at the place when nothing is in the way.
  void add(int place, const Vec3f& dir, const Rgbf& brings) {
    const auto k = static_cast<std::size_t>(place), slot = owners_.size();
    const float values[] = {at_.x[k], at_.y[k], at_.z[k], dir.x(), dir.y(), dir.z()};
    for (std::size_t i = 0; i < 6; ++i) arrays_[i][slot] = values[i];
    owners_.push_back(place);
    brought_.push_back(brings);
    if (owners_.size() == kRoom) flush();
  }

 private:
  static constexpr std::size_t kRoom = 256;

  void flush() {
    const std::size_t count = owners_.size();
    const std::size_t whole = (count + Tracer::kPacket - 1) / Tracer::kPacket * Tracer::kPacket;
    std::fill(wanted_.begin(), wanted_.end(), 0);
    std::fill_n(wanted_.begin(), count, -1);
    visibility_.keep(at_,
                     {arrays_[0].data(), arrays_[1].data(), arrays_[2].data(), arrays_[3].data(), arrays_[4].data(),
                      arrays_[5].data()},
                     Spread::kWide, std::span(wanted_).first(whole), traced_);
    for (std::size_t k = 0; k < count; ++k)
      if (wanted_[k]) out_.add(owners_[k], brought_[k]);
    owners_.clear();
    brought_.clear();
  }

  const Surfaces& at_;
  const Visibility& visibility_;
  Light& out_;
  std::int64_t& traced_;
  std::array<std::vector<float>, 6> arrays_;  ///< origins and directions
  std::vector<std::int32_t> wanted_, owners_;
  std::vector<Rgbf> brought_;
};

Gloss::Gloss(const Setting& setting, double share_of_probe)
    : scene_(setting.scene),
      visibility_(setting.tracer, setting.convex),
      light_(setting.light),
      share_(share_of_probe) {}

void Gloss::begin(const Pass& pass) {
  const ProbeShare shares = probe_share(pass, share_);
  const auto stream = [&](std::uint64_t use) {
    return address(pass.seed, static_cast<std::uint64_t>(pass.index), 0, use);
  };
  probe_pool_ = sobol_environment(light_, shares.of_probe, stream(4));
  surface_pool_ = sobol_hemisphere(shares.of_surface, stream(5));
}

void Gloss::radiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const {
  if (at.glossy.empty()) return;
  std::vector<Bsdf> surfaces;
  surfaces.reserve(at.glossy.size());
  for (const std::int32_t place : at.glossy) {
    const Hit& hit = *at.hits[static_cast<std::size_t>(place)];
    const Vec3f& viewer = at.viewers[static_cast<std::size_t>(place)];
    if (hit.material->color_texture || hit.material->surface_texture) {
      surfaces.emplace_back(material_at(scene_.meshes[hit.mesh], hit.triangle, hit.weights), hit.normal, viewer);
    } else {
      surfaces.emplace_back(*hit.material, hit.normal, viewer);
    }
  }
  Batch batch(at, visibility_, out, rays);
  from_probe(at, pass, surfaces, batch);
  from_surfaces(at, pass, surfaces, batch);
}

void Gloss::from_probe(const Surfaces& at, const Pass& pass, const std::vector<Bsdf>& surfaces, Batch& batch) const {
  const float probe_rows = static_cast<float>(probe_pool_.rows) / static_cast<float>(pass.camera_rays);
  const float surface_rows = static_cast<float>(surface_pool_.rows) / static_cast<float>(pass.camera_rays);
  for (int row = 0; row < probe_pool_.rows; ++row) {
    const int camera_ray = pass.camera_ray_of(row);
    const std::size_t begin = probe_pool_.begin(row, at.tile);
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      const int place = at.glossy[k];
      if (place / at.places != camera_ray) continue;
      const std::size_t i = begin + static_cast<std::size_t>(place % at.places);
      const Rgbf radiance(probe_pool_.red[i], probe_pool_.green[i], probe_pool_.blue[i]);
      if ((radiance <= 0).all()) continue;
      const Vec3f dir(probe_pool_.x[i], probe_pool_.y[i], probe_pool_.z[i]);
      const Rgbf scattered = surfaces[k].value_times_cosine(dir);
      if ((scattered <= 0).all()) continue;
      const float density =
          probe_rows * probe_pool_.pdf[i] + (surface_rows > 0 ? surface_rows * surfaces[k].pdf(dir) : 0.0f);
      if (density > 0) batch.add(place, dir, scattered * radiance / density);
    }
  }
}

void Gloss::from_surfaces(const Surfaces& at, const Pass& pass, const std::vector<Bsdf>& surfaces, Batch& batch) const {
  const float probe_rows = static_cast<float>(probe_pool_.rows) / static_cast<float>(pass.camera_rays);
  const float surface_rows = static_cast<float>(surface_pool_.rows) / static_cast<float>(pass.camera_rays);
  for (int row = 0; row < surface_pool_.rows; ++row) {
    const int camera_ray = pass.camera_ray_of(probe_pool_.rows + row);
    const std::size_t begin = surface_pool_.begin(row, at.tile);
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      const int place = at.glossy[k];
      if (place / at.places != camera_ray) continue;
      const std::size_t i = begin + static_cast<std::size_t>(place % at.places);
      const Vec3f dir = surfaces[k].sample(Vec2(surface_pool_.u[i], surface_pool_.v[i]));
      const Rgbf scattered = surfaces[k].value_times_cosine(dir);
      if ((scattered <= 0).all()) continue;
      const Environment::Sample light = light_.lookup(dir);
      if ((light.radiance <= 0).all()) continue;
      const float density = surface_rows * surfaces[k].pdf(dir) + (probe_rows > 0 ? probe_rows * light.pdf : 0.0f);
      if (density > 0) batch.add(place, dir, scattered * light.radiance / density);
    }
  }
}

}  // namespace hdr
