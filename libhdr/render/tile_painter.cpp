#include "libhdr/render/internal/tile_painter.h"

#include <algorithm>

#include "libhdr/core/color.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/film_filter.h"
#include "libhdr/render/internal/latlong_lookup.h"
#include "libhdr/render/internal/points.h"

namespace hdr {
namespace {

constexpr int kMirrorDepth = 4;
static_assert(TilePainter::kTile * TilePainter::kTile == DirectionPool::kVariants);

Vec3f mirrored(const Vec3f& dir, const Vec3f& normal) {
  return (dir - 2 * dir.dot(normal) * normal).normalized();
}

bool any_glossy(const Scene& scene) {
  return std::any_of(scene.meshes.begin(), scene.meshes.end(), [](const Mesh& mesh) {
    return mesh.material.kind != MaterialKind::kDiffuse && mesh.material.kind != MaterialKind::kMirror;
  });
}

double share_of_probe(RenderMethod method) {
  return method == RenderMethod::kMc ? 0 : method == RenderMethod::kImportance ? 1 : 0.5;
}

}  // namespace

struct TilePainter::Workspace {
  std::vector<Vec2> pixels;  ///< corners, in an order in which packets are square
  std::vector<std::size_t> indices;
  std::vector<std::uint64_t> streams;  ///< of random numbers
  Surfaces surfaces;
  std::vector<float> eye_x, eye_y, eye_z, px, py, dir_x, dir_y, dir_z;
  std::vector<std::optional<Hit>> hits;
  std::vector<Rgbf> carried;        ///< of each place: what mirrors on the way leave of its light
  std::vector<Rgbf> backdrop;       ///< of each place: the probe, seen beside the scene
  std::vector<std::size_t> beside;  ///< places of one camera ray that see it
  std::vector<Vec3f> beside_dirs;
  std::vector<Rgbf> beside_pixels;
  std::vector<Vec3f> normals;
  std::vector<std::uint8_t> covered, ground;  ///< by objects, and by shadow catchers
  Light irradiance, radiance;
};

TilePainter::TilePainter(const Setting& setting, RenderMethod method)
    : setting_(setting),
      size_(setting.options.size),
      across_((size_.width + kTile - 1) / kTile),
      down_((size_.height + kTile - 1) / kTile),
      camera_(setting.scene.camera, size_),
      integrator_(make_integrator(method, setting)),
      gloss_(setting, share_of_probe(method)),
      has_gloss_(any_glossy(setting.scene) && !integrator_->openness()) {
  // A cache keeps it.
  if (setting.options.bounces > 0 && reflects_light(method) && method != RenderMethod::kCache)
    interreflection_ = std::make_unique<Interreflection>(setting);
}

std::int64_t TilePainter::begin(const Pass& pass) {
  integrator_->begin(pass);
  if (has_gloss_) gloss_.begin(pass);
  if (interreflection_) interreflection_->begin(pass);
  return integrator_->shared_rays();
}

// Four blocks of 4 x 4, each a packet.
void TilePainter::find_pixels(int tile, const std::vector<std::uint8_t>& done, Workspace& work) const {
  work.pixels.clear();
  work.indices.clear();
  const int left = tile % across_ * kTile, top = tile / across_ * kTile;
  for (int k = 0; k < kTile * kTile; ++k) {
    const int x = left + (k % 4) + 4 * (k / 16 % 2), y = top + (k / 4 % 4) + 4 * (k / 32);
    if (x >= size_.width || y >= size_.height) continue;
    const auto index =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) + static_cast<std::size_t>(x);
    if (!done.empty() && done[index]) continue;
    work.pixels.emplace_back(x, y);
    work.indices.push_back(index);
  }
}

// What a camera ray sees: at most some mirrors, then a surface that scatters or the probe.
void TilePainter::follow(const Vec3f& towards, int place, std::optional<Hit>& hit, Workspace& work,
                         std::int64_t& rays) const {
  const auto k = static_cast<std::size_t>(place);
  Vec3f dir = towards;
  Rgbf carried = Rgbf::Ones();
  work.ground[k] = hit && hit->material->shadow_catcher;
  work.covered[k] = hit && !hit->material->shadow_catcher;
  const bool beside = !hit;
  work.normals[k] = hit ? hit->normal : Vec3f(Vec3f::Zero());
  const bool mirrors = !integrator_->openness();
  for (int depth = 0; hit && mirrors && hit->material->kind == MaterialKind::kMirror; ++depth) {
    if (depth == kMirrorDepth) return;  // what a fifth mirror would add is left black
    carried *= hit->material->color;
    dir = mirrored(dir, hit->normal);
    ++rays;
    hit = setting_.tracer.intersect(hit->position, dir);
  }
  work.carried[k] = carried;
  if (beside && !setting_.options.backdrop) return;
  if (hit) {
    work.surfaces.set(place, *hit, -dir, integrator_->openness());
  } else {
    work.beside.push_back(k);
    work.beside_dirs.push_back(dir);
  }
}

void TilePainter::trace(const Pass& pass, int camera_ray, Workspace& work, std::int64_t& rays) const {
  const std::size_t count = work.pixels.size();
  const SobolDigits digits(static_cast<std::uint32_t>(pass.first_camera_ray + camera_ray));
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 jitter = scrambled(digits, work.streams[k]);
    const Vec2 at = work.pixels[k] + filtered_place(setting_.options.filter, jitter);
    work.px[k] = static_cast<float>(at.x());
    work.py[k] = static_cast<float>(at.y());
  }
  camera_.dirs_from_px(work.px.data(), work.py.data(), static_cast<int>(count), work.dir_x.data(), work.dir_y.data(),
                       work.dir_z.data());
  rays += static_cast<std::int64_t>(count);
  setting_.tracer.intersect({work.eye_x.data(), work.eye_y.data(), work.eye_z.data(), work.dir_x.data(),
                             work.dir_y.data(), work.dir_z.data()},
                            std::span(work.hits).first(count));
  for (std::size_t k = 0; k < count; ++k) {
    follow({work.dir_x[k], work.dir_y[k], work.dir_z[k]}, camera_ray * work.surfaces.places + static_cast<int>(k),
           work.hits[k], work, rays);
  }
  work.beside_pixels.resize(work.beside.size());
  smooth_pixels(setting_.light.latlong(), work.beside_dirs, work.beside_pixels);
  for (std::size_t k = 0; k < work.beside.size(); ++k)
    work.backdrop[work.beside[k]] = work.carried[work.beside[k]] * work.beside_pixels[k];
  work.beside.clear();
  work.beside_dirs.clear();
}

// The mean over each pixel's camera rays.
void TilePainter::collect(const Pass& pass, Workspace& work, Film& film) const {
  const float share = 1 / static_cast<float>(pass.camera_rays);
  for (std::size_t pixel = 0; pixel < work.pixels.size(); ++pixel) {
    PixelEstimate estimate;
    for (int ray = 0; ray < pass.camera_rays; ++ray) {
      const std::size_t k = static_cast<std::size_t>(ray * work.surfaces.places) + pixel;
      const int place = static_cast<int>(k);
      Rgbf radiance = work.radiance.of(place);
      if (integrator_->openness()) {
        radiance = work.irradiance.of(place);
      } else if (work.surfaces.diffuse[k]) {
        const Rgbf reflected = diffuse_albedo(setting_.scene, *work.surfaces.hits[k]) / static_cast<float>(kPi);
        radiance += work.irradiance.of(place) * reflected;
        if (!work.irradiance.doubt.empty()) {
          const Rgbf doubt = work.carried[k] * reflected * work.irradiance.doubt[k];
          estimate.doubt += static_cast<double>(luminance(doubt[0], doubt[1], doubt[2]));
        }
      }
      const Rgb seen = (work.carried[k] * radiance + work.backdrop[k]).cast<double>();
      estimate.radiance += seen;
      if (work.ground[k]) {
        estimate.ground += seen;
        estimate.ground_share += 1;
      }
      estimate.normal += work.normals[k];
      estimate.coverage += work.covered[k];
    }
    estimate.radiance *= static_cast<double>(share);
    estimate.normal *= share;
    estimate.coverage *= share;
    estimate.ground *= static_cast<double>(share);
    estimate.doubt *= static_cast<double>(share);
    estimate.ground_share *= share;
    film.add(work.indices[pixel], estimate, pass.directions);
  }
}

void TilePainter::paint(int tile, const Pass& pass, const std::vector<std::uint8_t>& done, Film& film,
                        Tally& tally) const {
  static thread_local Workspace work;
  find_pixels(tile, done, work);
  const auto pixels = static_cast<int>(work.pixels.size());
  if (pixels == 0) return;
  work.streams.clear();
  for (const std::size_t index : work.indices) work.streams.push_back(address(pass.seed, index, 0, 0));
  const int places = (pixels + Tracer::kPacket - 1) / Tracer::kPacket * Tracer::kPacket;
  const auto all = static_cast<std::size_t>(places * pass.camera_rays);
  work.surfaces.resize(places, pass.camera_rays);
  work.surfaces.tile = static_cast<std::uint32_t>(hash64(static_cast<std::uint64_t>(tile)));
  const auto room = static_cast<std::size_t>(places);
  work.eye_x.assign(room, camera_.eye().x());
  work.eye_y.assign(room, camera_.eye().y());
  work.eye_z.assign(room, camera_.eye().z());
  for (auto* array : {&work.px, &work.py, &work.dir_x, &work.dir_y, &work.dir_z}) array->assign(room, 0.0f);
  work.hits.resize(room);
  work.carried.assign(all, Rgbf::Zero());
  work.backdrop.assign(all, Rgbf::Zero());
  work.normals.assign(all, Vec3f::Zero());
  work.covered.assign(all, 0);
  work.ground.assign(all, 0);
  work.irradiance.reset(places * pass.camera_rays);
  work.radiance.reset(places * pass.camera_rays);
  for (int ray = 0; ray < pass.camera_rays; ++ray) trace(pass, ray, work, tally.rays);
  // Beside the scene, and on gloss alone, nobody asks what light arrives.
  const bool asked = work.surfaces.any_diffuse;
  if (asked) integrator_->irradiance(work.surfaces, pass, work.irradiance, tally.rays);
  if (asked && interreflection_) interreflection_->irradiance(work.surfaces, pass, work.irradiance, tally.rays);
  if (has_gloss_) gloss_.radiance(work.surfaces, pass, work.radiance, tally.rays);
  collect(pass, work, film);
  tally.directions += std::int64_t{pixels} * pass.directions;
  tally.backs += !work.surfaces.fronts;
}

}  // namespace hdr
