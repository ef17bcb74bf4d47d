// Irradiance cache [Ward88]: irradiance changes slowly, and is computed at few points. The probe is taken in two. Its
// compact lights cast shadows with edges, and are sampled at every pixel. Of the soft rest, what an unoccluded surface
// receives is known for every normal; what occluders take from it is cached, with gradients [Ward92] and an error that
// the Hessian of occlusion bounds [Schwarzhaupt12]. Where records are and how far
// they reach is found once; each pass lets them say anew what they see, so that its spread tells of their noise. What
// interpolation adds is the same in every pass: records foretell each other, and how far off they are is a doubt that
// goes with the light.
#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/light/sh.h"
#include "libhdr/light/split_lights.h"
#include "libhdr/render/bounds.h"
#include "libhdr/render/internal/camera_rays.h"
#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/interreflection.h"
#include "libhdr/render/internal/latlong_lookup.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/internal/record_octree.h"

namespace hdr {
namespace {

constexpr Size kIrradianceTable{256, 128};
constexpr int kIrradianceDegree = 10;

Image<float> unoccluded_irradiance(View<const float> soft) {
  return irradiance_map(project(soft, LatLong{soft.size()}, kIrradianceDegree), kIrradianceTable);
}

RecordOctree octree_around(const Scene& scene) {
  const auto [low, high] = bounds_of(scene);
  if (!(low.array() <= high.array()).all()) return {Vec3f::Zero(), 1};
  return {(low + high) / 2, 0.51f * (high - low).maxCoeff() + 1e-6f};
}

// Pixels from coarse to fine: those whose columns and rows are odd multiples of the step or even of twice it.
std::vector<std::int32_t> refinement(Size size, int step, bool first, std::uint64_t stream) {
  std::vector<std::int32_t> pixels;
  for (int y = 0; y < size.height; y += step)
    for (int x = 0; x < size.width; x += step)
      if (first || x % (2 * step) != 0 || y % (2 * step) != 0) pixels.push_back(y * size.width + x);
  // In no order: what is computed together should not lie together.
  Random random(stream, 3);
  for (std::size_t k = pixels.size(); k > 1; --k)
    std::swap(pixels[k - 1], pixels[(std::uint64_t{random.bits()} * k) >> 32]);
  return pixels;
}

class Cache : public Integrator {
 public:
  explicit Cache(const Setting& setting)
      : setting_(setting),
        lights_(split_lights(setting.light.latlong())),
        table_(unoccluded_irradiance(lights_.soft)),
        interreflection_(setting.options.bounces > 0 ? std::make_unique<Interreflection>(setting) : nullptr),
        maker_(setting.tracer, lights_.soft, interreflection_.get()),
        records_(octree_around(setting.scene)) {
    if (!(lights_.share > 0)) return;
    compact_ = std::make_unique<Environment>(std::move(lights_.compact));
    compact_setting_ = std::make_unique<Setting>(
        Setting{setting.scene, setting.tracer, *compact_, setting.options, setting.convex, setting.sh_degree});
    suns_ = make_mis(*compact_setting_, 1);
  }

  void begin(const Pass& pass) override {
    if (suns_) suns_->begin(pass);
    if (interreflection_) interreflection_->begin(pass);
    stream_ = address(pass.seed, static_cast<std::uint64_t>(pass.index), 0, 8);
    directions_ = std::clamp(kPerDirection * pass.directions, kFewest, kMost);
    filling_rays_ = 0;
    if (setting_.convex) return;  // nothing is in the way, or it is seen from behind: each place by itself
    if (records_.size() == 0) fill();
    say_again();
    std::vector<Rgbf> skies;
    for (const IrradianceRecord& record : records_.records()) skies.push_back(smooth_pixel(table_, record.normal));
    records_.doubt(skies);
  }

  std::vector<Vec2f> record_points() const override { return points_; }
  std::int64_t shared_rays() const override { return filling_rays_; }

  void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const override {
    if (suns_) suns_->irradiance(at, pass, out, rays);
    out.doubt.assign(static_cast<std::size_t>(at.count()), 0.0f);
    for (int place = 0; place < at.count(); ++place) {
      const auto k = static_cast<std::size_t>(place);
      if (!at.diffuse[k]) continue;
      const Vec3f position(at.x[k], at.y[k], at.z[k]), normal(at.normal_x[k], at.normal_y[k], at.normal_z[k]);
      const Rgbf sky = smooth_pixel(table_, normal);
      Rgbf loss = Rgbf::Zero();
      if (!(setting_.convex && at.fronts)) {
        const std::optional<RecordOctree::Said> cached = records_.loss(position, normal, sky);
        if (cached) {
          loss = cached->loss;
          out.doubt[k] = cached->doubt;
        } else {
          loss = maker_
                     .record(place_of(position, normal), directions_,
                             address(stream_, at.tile, static_cast<std::uint64_t>(place), 9), rays)
                     .loss;
        }
      }
      out.add(place, (sky - loss).max(0.0f));
    }
  }

 private:
  static constexpr int kPerDirection = 8, kFewest = 128, kMost = 2048;
  static constexpr int kCoarsest = 32, kTogether = 32;

  RecordPlace place_of(const Vec3f& position, const Vec3f& normal) const {
    const Rgbf sky = smooth_pixel(table_, normal);
    const Camera& camera = setting_.scene.camera;
    const auto pixel = static_cast<float>(2 * std::tan(camera.fov_degrees * kHalfDegree) / setting_.options.size.width);
    return {position, normal, pixel * (position - camera.eye).norm(), luminance(sky[0], sky[1], sky[2])};
  }

  // What the middle of a pixel shows, by way of mirrors.
  std::optional<Hit> seen(const CameraRays& camera, std::int32_t pixel) const {
    const int width = setting_.options.size.width;
    Vec3f dir = camera.dir_from_px({pixel % width + 0.5, pixel / width + 0.5});
    std::optional<Hit> hit = setting_.tracer.intersect(camera.eye(), dir);
    for (int depth = 0; hit && hit->material->kind == MaterialKind::kMirror; ++depth) {
      if (depth == 4) return std::nullopt;
      dir = (dir - 2 * dir.dot(hit->normal) * hit->normal).normalized();
      hit = setting_.tracer.intersect(hit->position, dir);
    }
    if (hit && hit->material->kind != MaterialKind::kDiffuse) hit.reset();
    return hit;
  }

  // Coarse to fine, a record wherever none reaches. Blocks have fixed sizes: the cache does not depend on the number of
  // threads.
  void fill() {
    const CameraRays camera(setting_.scene.camera, setting_.options.size);
    constexpr int kBlock = 2048;
    for (int step = kCoarsest; step >= 1; step /= 2) {
      const std::vector<std::int32_t> pixels = refinement(setting_.options.size, step, step == kCoarsest,
                                                          address(stream_, static_cast<unsigned>(step), 0, 1));
      for (std::size_t begin = 0; begin < pixels.size(); begin += kBlock)
        fill(camera, std::span(pixels).subspan(begin, std::min<std::size_t>(kBlock, pixels.size() - begin)));
    }
  }

  void fill(const CameraRays& camera, std::span<const std::int32_t> pixels) {
    std::vector<std::optional<Hit>> bare(pixels.size());
    for_rows(static_cast<int>(pixels.size()), 64, [&](int first, int last) {
      for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
        bare[k] = seen(camera, pixels[k]);
        if (bare[k] && records_.covered(bare[k]->position, bare[k]->normal)) bare[k].reset();
      }
    });
    filling_rays_ += static_cast<std::int64_t>(pixels.size());
    std::vector<std::size_t> together;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      if (bare[k] && !records_.covered(bare[k]->position, bare[k]->normal)) together.push_back(k);
      if (together.size() == kTogether || (k + 1 == pixels.size() && !together.empty())) {
        compute(bare, pixels, together);
        together.clear();
      }
    }
  }

  void compute(const std::vector<std::optional<Hit>>& hits, std::span<const std::int32_t> pixels,
               const std::vector<std::size_t>& which) {
    std::vector<IrradianceRecord> made(which.size());
    std::vector<std::int64_t> rays(which.size(), 0);
    for_rows(static_cast<int>(which.size()), 4, [&](int first, int last) {
      for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
        const Hit& hit = *hits[which[k]];
        made[k] = maker_.record(place_of(hit.position, hit.normal), directions_,
                                address(stream_, static_cast<std::uint64_t>(pixels[which[k]]), 1, 2), rays[k]);
      }
    });
    for (std::size_t k = 0; k < which.size(); ++k) {
      records_.add(made[k]);
      const int pixel = pixels[which[k]], width = setting_.options.size.width;
      points_.emplace_back(static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f);
      filling_rays_ += rays[k];
    }
  }

  void say_again() {
    std::vector<IrradianceRecord>& records = records_.records();
    filling_rays_ += reduce_rows(
        static_cast<int>(records.size()), 16, std::int64_t{0},
        [&](int first, int last) {
          std::int64_t rays = 0;
          for (int k = first; k < last; ++k) {
            maker_.say_again(records[static_cast<std::size_t>(k)], directions_,
                             address(stream_, static_cast<std::uint64_t>(k), 2, 4), rays);
          }
          return rays;
        },
        [](std::int64_t& total, std::int64_t part) { total += part; });
  }

  static constexpr double kHalfDegree = 3.14159265358979323846 / 360;

  const Setting& setting_;
  SplitLights lights_;
  Image<float> table_;  ///< irradiance of the soft part, by normal
  std::unique_ptr<Interreflection> interreflection_;
  RecordMaker maker_;
  RecordOctree records_;
  std::vector<Vec2f> points_;
  std::unique_ptr<Environment> compact_;
  std::unique_ptr<Setting> compact_setting_;
  std::unique_ptr<Integrator> suns_;
  std::uint64_t stream_ = 0;
  std::int64_t filling_rays_ = 0;
  int directions_ = kFewest;
};

}  // namespace

std::unique_ptr<Integrator> make_cache(const Setting& setting) {
  return std::make_unique<Cache>(setting);
}

}  // namespace hdr
