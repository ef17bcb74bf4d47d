#include "libhdr/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/render/internal/camera_rays.h"
#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/points.h"

namespace hdr {
namespace {

struct NamedMethod {
  const char* name;
  RenderMethod method;
};
constexpr std::array<NamedMethod, 6> kMethods{{{"auto", RenderMethod::kAuto},
                                               {"mc", RenderMethod::kMc},
                                               {"importance", RenderMethod::kImportance},
                                               {"mis", RenderMethod::kMis},
                                               {"sh", RenderMethod::kSh},
                                               {"prt", RenderMethod::kPrt}}};

// How a pixel's samples are spent: camera rays, each with its own stratified set of directions. The rays' results are
// independent, and so their spread is an honest standard error.
struct Budget {
  int camera_rays, directions;
};

// The divisor of `samples` nearest to its square root, from above: at least two camera rays, to have a spread.
Budget budget_of(int samples) {
  int rays = std::max(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(samples)))), std::min(samples, 4));
  while (samples % rays != 0) ++rays;
  return {rays, samples / rays};
}

// What a block of rows tells about the picture.
struct Tally {
  std::int64_t rays = 0;
  std::int64_t pixels = 0;       ///< fully covered and lit
  double relative_variance = 0;  ///< sum over them of (standard error / value)^2
};

class Painter {
 public:
  Painter(const Scene& scene, const Environment& light, const RenderOptions& options, RenderMethod method)
      : options_(options),
        budget_(budget_of(options.samples)),
        camera_(scene.camera, options.size),
        integrator_(scene, light, method, budget_.directions) {
    if (method == RenderMethod::kPrt) integrator_.relight(options.transfer);
  }

  const Integrator& integrator() const { return integrator_; }

  void paint(int x, int y, RadianceMap& picture, Tally& tally) const {
    const auto pixel =
        static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(options_.size.width) + static_cast<std::uint64_t>(x);
    Rgb sum = Rgb::Zero();
    double mean = 0, squares = 0;  // of luminance, by Welford's update
    int hits = 0;
    for (int ray = 0; ray < budget_.camera_rays; ++ray) {
      const Vec2 jitter = sobol_point(static_cast<std::uint32_t>(ray), address(options_.seed, pixel, 0, 0));
      const Vec3f dir = camera_.dir_from_px({x + jitter.x(), y + jitter.y()});
      const Integrator::Seen seen = integrator_.seen(
          camera_.eye(), dir, address(options_.seed, pixel, static_cast<std::uint64_t>(ray), 1), tally.rays);
      sum += seen.radiance;
      hits += seen.hit;
      const double value = luminance(seen.radiance[0], seen.radiance[1], seen.radiance[2]);
      const double step = value - mean;
      mean += step / (ray + 1);
      squares += step * (value - mean);
    }
    const Rgb colour = (sum / budget_.camera_rays).min(static_cast<double>(std::numeric_limits<float>::max()));
    for (int c = 0; c < 3; ++c) picture.rgb(x, y, c) = static_cast<float>(colour[c]);
    picture.alpha(x, y) = static_cast<float>(hits) / static_cast<float>(budget_.camera_rays);
    if (hits < budget_.camera_rays || !(mean > 0) || budget_.camera_rays < 2) return;
    const double variance_of_mean = squares / (budget_.camera_rays - 1) / budget_.camera_rays;
    tally.relative_variance += variance_of_mean / (mean * mean);
    ++tally.pixels;
  }

 private:
  const RenderOptions& options_;
  Budget budget_;
  CameraRays camera_;
  Integrator integrator_;
};

double error_from(const Tally& tally, int samples) {
  if (samples < 2) return 1;
  return tally.pixels > 0 ? std::sqrt(tally.relative_variance / static_cast<double>(tally.pixels)) : 0;
}

}  // namespace

std::optional<RenderMethod> render_method_from_name(const std::string& name) {
  for (const NamedMethod& known : kMethods)
    if (name == known.name) return known.method;
  return std::nullopt;
}

const char* name_of(RenderMethod method) {
  const auto* known = std::find_if(kMethods.begin(), kMethods.end(), [&](auto& m) { return m.method == method; });
  HDR_ASSERT(known != kMethods.end());
  return known->name;
}

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
  result.picture.rgb = Image<float>(size, 3);
  result.picture.alpha = Image<float>(size, 1);
  const Painter painter(scene, light, options, result.method);
  std::atomic<int> rows_done = 0;
  const Tally tally = reduce_rows(
      size.height, 1, Tally{},
      [&](int first, int last) {
        Tally part;
        for (int y = first; y < last; ++y)
          for (int x = 0; x < size.width; ++x) painter.paint(x, y, result.picture, part);
        const int done = rows_done += last - first;
        if (options.progress) options.progress(static_cast<double>(done) / size.height);
        return part;
      },
      [](Tally& total, const Tally& part) {
        total.rays += part.rays;
        total.pixels += part.pixels;
        total.relative_variance += part.relative_variance;
      });
  result.rays = tally.rays;
  result.samples_per_pixel = options.samples;
  result.estimated_error = error_from(tally, options.samples);
  if (painter.integrator().skips_shadow_rays()) {
    result.skipped = "shadow rays: the scene is convex, nothing can occlude; error 0";
  }
  return result;
}

}  // namespace hdr
