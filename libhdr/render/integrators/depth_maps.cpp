// Ambient occlusion as the lecture draws it: the scene's depth from many sides of the sky, accumulated. A surface sees
// as much of the sky as there are maps in which nothing is nearer, by the cosine of each: E / E_unoccluded = mean of
// 4 max(0, n . w) V over directions w of the whole sphere.
#include <algorithm>
#include <limits>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/camera_rays.h"
#include "libhdr/render/internal/depth_map.h"
#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/points.h"

namespace hdr {
namespace {

class AoOfDepthMaps : public Integrator {
 public:
  explicit AoOfDepthMaps(const Setting& setting) : scene_(setting.scene) {
    const CameraRays camera(setting.scene.camera, setting.options.size);
    low_ = Vec3f::Constant(std::numeric_limits<float>::max());
    high_ = -low_;
    // What the picture shows is all that asks for the sky.
    for (int y = 0; y <= setting.options.size.height; ++y) {
      for (int x = 0; x <= setting.options.size.width; ++x) {
        if (const auto hit = setting.tracer.intersect(camera.eye(), camera.dir_from_px(Vec2(x, y)))) {
          low_ = low_.cwiseMin(hit->position);
          high_ = high_.cwiseMax(hit->position);
        }
      }
    }
  }

  void begin(const Pass& pass) override {
    maps_.clear();
    maps_.resize(static_cast<std::size_t>(pass.directions));
    if (!(low_.array() <= high_.array()).all()) return;
    const std::uint64_t stream = address(pass.seed, static_cast<std::uint64_t>(pass.index), 0, 10);
    for_rows(pass.directions, 1, [&](int first, int last) {
      for (int k = first; k < last; ++k) {
        const Vec2 u = sobol_point(static_cast<std::uint32_t>(k), stream);
        const double z = 2 * u.x() - 1, azimuth = 2 * kPi * u.y(), sine = std::sqrt(std::max(0.0, 1 - z * z));
        const Vec3 towards(sine * std::cos(azimuth), sine * std::sin(azimuth), z);
        maps_[static_cast<std::size_t>(k)] = DepthMap(scene_, towards.cast<float>(), low_, high_, kSide);
      }
    });
  }

  void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t&) const override {
    std::vector<float>& open = out.rgb[0];
    const float share = 4 * static_cast<float>(pass.camera_rays) / static_cast<float>(pass.directions);
    for (int row = 0; row < pass.directions; ++row) {
      const DepthMap& map = maps_[static_cast<std::size_t>(row)];
      const int first = pass.camera_ray_of(row) * at.places;
      for (int place = first; place < first + at.places; ++place) {
        const auto k = static_cast<std::size_t>(place);
        if (!at.diffuse[k]) continue;
        const float cosine = Vec3f(at.normal_x[k], at.normal_y[k], at.normal_z[k]).dot(map.towards());
        if (cosine > 0) open[k] += share * cosine * map.open(at.hits[k]->position, at.hits[k]->geometric);
      }
    }
    out.rgb[1] = out.rgb[2] = open;
  }

  int most_directions() const override { return kMapsAtOnce; }
  bool openness() const override { return true; }

 private:
  static constexpr int kSide = 512, kMapsAtOnce = 64;  ///< 64 MB

  const Scene& scene_;
  Vec3f low_, high_;
  std::vector<DepthMap> maps_;
};

}  // namespace

std::unique_ptr<Integrator> make_ao_of_depth_maps(const Setting& setting) {
  return std::make_unique<AoOfDepthMaps>(setting);
}

}  // namespace hdr
