#include "libhdr/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "libhdr/core/parallel.h"
#include "libhdr/render/internal/tile_painter.h"

namespace hdr {
namespace {

// Vertices so close that light is linear between them: a hundred or so across the picture.
constexpr float kEdgesAcross = 100;

Scene with_fine_meshes(const Scene& scene) {
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max()), high = -low;
  for (const Mesh& mesh : scene.meshes) {
    for (const Vec3f& p : mesh.positions) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  Scene fine = scene;
  for (Mesh& mesh : fine.meshes)
    mesh = tessellated(with_smooth_normals(std::move(mesh)), (high - low).maxCoeff() / kEdgesAcross);
  return fine;
}

// Passes that together spend `samples` directions a pixel. Two tell the error; more tell it better, but each on its own
// is less well stratified. Camera rays: some for the edges of things, and few where nothing else is random.
std::vector<Pass> planned(const RenderOptions& options, bool exact) {
  const int samples = options.samples;
  const int passes = samples < 4 ? samples : std::clamp(samples / 32, 4, 8);
  const int rays_in_all = exact ? std::clamp(samples / 8, std::min(samples, 4), 16) : std::max(passes, 16);
  std::vector<Pass> plan;
  for (int k = 0; k < passes; ++k) {
    const int directions = samples / passes + (k < samples % passes ? 1 : 0);
    plan.push_back({k, directions, std::clamp(rays_in_all / passes, 1, directions), options.seed});
  }
  return plan;
}

// Bytes of the picture do not depend on who painted which tile.
std::int64_t paint_pass(TilePainter& painter, const Pass& pass, Film& film,
                        const std::function<void(double)>& progress) {
  painter.begin(pass);
  std::atomic<int> tiles_done = 0;
  constexpr int kTilesAtOnce = 4;
  return reduce_rows(
      painter.tiles(), kTilesAtOnce, std::int64_t{0},
      [&](int first, int last) {
        std::int64_t rays = 0;
        for (int tile = first; tile < last; ++tile) painter.paint(tile, pass, {}, film, rays);
        const int done = tiles_done += last - first;
        if (progress) progress(static_cast<double>(done) / painter.tiles());
        return rays;
      },
      [](std::int64_t& total, std::int64_t part) { total += part; });
}

void develop_ground(const Film& film, Rendering& result) {
  const Size size = film.size();
  result.ground = Image<float>(size, 4);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const std::size_t pixel = film.index(x, y);
      const Rgb light = film.ground(pixel).min(static_cast<double>(std::numeric_limits<float>::max()));
      for (int c = 0; c < 3; ++c) result.ground(x, y, c) = static_cast<float>(light[c]);
      result.ground(x, y, 3) = film.ground_share(pixel);
    }
  }
}

void develop(const Film& film, Rendering& result) {
  const Size size = film.size();
  result.picture.rgb = Image<float>(size, 3);
  result.picture.alpha = Image<float>(size, 1);
  result.normal = Image<float>(size, 3);
  result.variance = Image<float>(size, 1);
  constexpr double kLargest = std::numeric_limits<float>::max();
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const std::size_t pixel = film.index(x, y);
        const Rgb colour = film.radiance(pixel).min(kLargest);
        const Vec3f normal = film.normal(pixel);
        for (int c = 0; c < 3; ++c) {
          result.picture.rgb(x, y, c) = static_cast<float>(colour[c]);
          result.normal(x, y, c) = normal[c];
        }
        result.picture.alpha(x, y) = film.coverage(pixel);
        result.variance(x, y) = static_cast<float>(std::clamp(film.variance(pixel), 0.0, kLargest));
      }
    }
  });
}

double error_of(const Film& film, int samples) {
  if (samples < 2) return 1;
  double relative_variance = 0;
  std::int64_t lit = 0;
  for (int y = 0; y < film.size().height; ++y) {
    for (int x = 0; x < film.size().width; ++x) {
      const std::size_t pixel = film.index(x, y);
      const double value = film.luminance_of(pixel);
      if (film.coverage(pixel) < 1 || !(value > 0)) continue;
      relative_variance += film.variance(pixel) / (value * value);
      ++lit;
    }
  }
  return lit > 0 ? std::sqrt(relative_variance / static_cast<double>(lit)) : 0;
}

}  // namespace

Rendering render(const Scene& scene, const Environment& light, const RenderOptions& options) {
  if (options.method == RenderMethod::kPrt && options.transfer.empty() && !scene.meshes.empty()) {
    RenderOptions ready = options;
    const Scene fine = with_fine_meshes(scene);
    ready.transfer = diffuse_transfer(fine, {4, 256, options.seed, {}});
    return render(fine, light, ready);
  }
  const Size size = options.size;
  if (size.width < 1 || size.height < 1 || options.samples < 1) {
    throw Error(fmt::format("cannot render {}x{} pixels with {} samples; each must be at least 1", size.width,
                            size.height, options.samples));
  }
  Rendering result;
  result.method = options.method == RenderMethod::kAuto ? RenderMethod::kMis : options.method;
  const Tracer tracer(scene, result.method == RenderMethod::kSh ? Tracer::Effort::kFewRays : Tracer::Effort::kManyRays);
  const Setting setting{scene, tracer, light, options, tracer.convex()};
  TilePainter painter(setting, result.method);
  Film film(size);
  const std::vector<Pass> passes = planned(options, painter.exact());
  for (const Pass& pass : passes) {
    const auto report = [&](double done) {
      if (options.progress) options.progress((pass.index + done) / static_cast<double>(passes.size()));
    };
    result.rays += paint_pass(painter, pass, film, report);
  }
  develop(film, result);
  if (std::any_of(scene.meshes.begin(), scene.meshes.end(), [](auto& mesh) { return mesh.material.shadow_catcher; }))
    develop_ground(film, result);
  result.samples_per_pixel = options.samples;
  result.estimated_error = error_of(film, options.samples);
  if (setting.convex && !painter.exact()) {
    result.skipped = "shadow rays: the scene is convex, nothing can occlude; error 0";
  }
  return result;
}

}  // namespace hdr
