#include "libhdr/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "libhdr/core/parallel.h"
#include "libhdr/render/bounds.h"
#include "libhdr/render/internal/allotment.h"
#include "libhdr/render/internal/tile_painter.h"

namespace hdr {
namespace {

// Vertices so close that light is linear between them: a hundred or so across the picture.
constexpr float kEdgesAcross = 100;

Scene with_fine_meshes(const Scene& scene) {
  const auto [low, high] = bounds_of(scene);
  Scene fine = scene;
  for (Mesh& mesh : fine.meshes)
    mesh = tessellated(with_smooth_normals(std::move(mesh)), (high - low).maxCoeff() / kEdgesAcross);
  return fine;
}

// A picture in the making.
class Painting {
 public:
  Painting(const Setting& setting, RenderMethod method)
      : options_(setting.options), painter_(setting, method), film_(setting.options.size) {}

  // One pass over those pixels that are not `done`.
  void pass(int directions, const std::vector<std::uint8_t>& done) {
    // Camera rays are for the edges of things, and for nothing else where irradiance is exact.
    const int rays =
        exact() ? 1 : std::clamp((directions + 3) / 4, std::min(directions, 4), std::clamp(directions / 16, 8, 256));
    const Pass pass{passes_++, directions, rays, options_.seed, camera_rays_};
    camera_rays_ += rays;
    tally_.rays += painter_.begin(pass);
    std::atomic<int> tiles_done = 0;
    constexpr int kTilesAtOnce = 4;
    // The bytes of the picture do not depend on who paints which tile.
    const Tally tally = reduce_rows(
        painter_.tiles(), kTilesAtOnce, Tally{},
        [&](int first, int last) {
          Tally part;
          for (int tile = first; tile < last; ++tile) painter_.paint(tile, pass, done, film_, part);
          const int ready = tiles_done += last - first;
          report(progress_from_ + (progress_to_ - progress_from_) * ready / painter_.tiles());
          return part;
        },
        [](Tally& total, const Tally& part) { total += part; });
    tally_ += tally;
    progress_from_ = progress_to_;
  }

  void passes(const Allotment& allotment) {
    for (int level = 0; level <= allotment.highest; ++level) {
      const std::vector<std::uint8_t> others = allotment.others(level);
      if (std::find(others.begin(), others.end(), 0) != others.end()) pass(allotment.directions(level), others);
    }
  }

  // The next pass goes on to this share of the work.
  void next_goes_to(double share) { progress_to_ = share; }

  std::vector<Vec2f> record_points() const { return painter_.record_points(); }
  int most_directions() const { return painter_.most_directions(); }
  bool exact() const { return painter_.exact(); }
  bool saw_backs() const { return tally_.backs > 0; }
  const Film& film() const { return film_; }
  std::int64_t rays() const { return tally_.rays; }
  double samples_per_pixel() const {
    return static_cast<double>(tally_.directions) / static_cast<double>(film_.count());
  }

 private:
  void report(double done) const {
    if (options_.progress) options_.progress(std::min(done, 1.0));
  }

  const RenderOptions& options_;
  TilePainter painter_;
  Film film_;
  Tally tally_;
  int passes_ = 0, camera_rays_ = 0;
  double progress_from_ = 0, progress_to_ = 1;
};

// Two passes tell the error; each on its own is the better stratified the more directions it has.
void paint_evenly(Painting& painting, int samples) {
  const int most = painting.exact() ? 16 : samples > 1024 ? 4 : 2;
  const int fewest = (samples - 1) / painting.most_directions() + 1;
  const int passes = painting.exact() ? std::clamp(samples / 8, std::min(samples, 4), most)
                                      : std::max(fewest, std::min(samples, most));
  for (int k = 0; k < passes; ++k) {
    painting.next_goes_to((k + 1.0) / passes);
    painting.pass(samples / passes + (k < samples % passes ? 1 : 0), {});
  }
}

// Half of the work everywhere, the other half where the first says that it is needed.
void paint_where_needed(Painting& painting, int samples) {
  const int pilot = samples / 4;
  for (int k = 0; k < 2; ++k) {
    painting.next_goes_to(0.25 * (k + 1));
    painting.pass(pilot, {});
  }
  const std::vector<float> deviations = relative_deviations(painting.film());
  const auto in_need = std::count_if(deviations.begin(), deviations.end(), [](float d) { return d > 0; });
  const Allotment allotment =
      allot_budget(painting.film(), deviations, static_cast<double>(samples - 2 * pilot) * static_cast<double>(in_need),
                   std::max(1, samples / 4));
  painting.next_goes_to(1);
  painting.passes(allotment);
}

// Until each pixel's estimated relative error is `error`, or it has had `most` directions.
void paint_to_error(Painting& painting, double error, int most) {
  const int pilot = std::clamp(most / 2, 1, 16);
  for (int k = 0; k < 2; ++k) painting.pass(pilot, {});
  for (bool all_there = false; !all_there;) {
    const Allotment allotment =
        allot_to_error(painting.film(), relative_deviations(painting.film()), error, pilot, most);
    const auto there = std::count(allotment.levels.begin(), allotment.levels.end(), -1);
    painting.next_goes_to(static_cast<double>(there) / static_cast<double>(allotment.levels.size()));
    painting.passes(allotment);
    all_there = allotment.highest < 0;
  }
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
        result.variance(x, y) = static_cast<float>(std::clamp(film.square_error(pixel), 0.0, kLargest));
      }
    }
  });
}

double error_of(const Film& film) {
  double relative_variance = 0;
  std::int64_t lit = 0;
  for (std::size_t pixel = 0; pixel < film.count(); ++pixel) {
    const double value = film.luminance_of(pixel), variance = film.square_error(pixel);
    if (variance < 0) return 1;  // one pass tells nothing of its error
    if (film.coverage(pixel) < 1 || !(value > 0)) continue;
    relative_variance += variance / (value * value);
    ++lit;
  }
  return lit > 0 ? std::sqrt(relative_variance / static_cast<double>(lit)) : 0;
}

bool has_shadow_catcher(const Scene& scene) {
  return std::any_of(scene.meshes.begin(), scene.meshes.end(), [](auto& mesh) { return mesh.material.shadow_catcher; });
}

void paint(Painting& painting, const Scene& scene, const RenderOptions& options) {
  // Half of too little tells nothing: with fewer than these all pixels have the same.
  constexpr int kFewest = 16;
  if (options.error > 0) {
    paint_to_error(painting, options.error, options.samples);
  } else if (options.method == RenderMethod::kAuto && !painting.exact() && options.samples >= kFewest &&
             !has_shadow_catcher(scene)) {
    paint_where_needed(painting, options.samples);
  } else {
    paint_evenly(painting, options.depth_maps > 0 ? options.depth_maps : options.samples);
  }
}

void finish(const Painting& painting, const Scene& scene, Rendering& result) {
  develop(painting.film(), result);
  if (has_shadow_catcher(scene)) develop_ground(painting.film(), result);
  result.rays += painting.rays();
  result.cache_points = painting.record_points();
  result.samples_per_pixel = painting.samples_per_pixel();
  result.estimated_error = error_of(painting.film());
}

void check_depth_maps(const RenderOptions& options) {
  if (options.depth_maps == 0) return;
  const RenderMethod method = options.method;
  if (options.depth_maps < 0) throw Error("a picture cannot be made of less than 0 depth maps");
  if (method != RenderMethod::kAo && method != RenderMethod::kShAo && method != RenderMethod::kMeanAo) {
    throw Error(
        fmt::format("{} looks at no depth maps; leave --depth-maps, or use ao, sh-ao or mean-ao", name_of(method)));
  }
  if (options.error > 0) throw Error("so many depth maps or an error to reach: leave --depth-maps or --error");
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
  if (!(options.error >= 0)) throw Error("the error to reach must not be negative; 0 is for a fixed number of samples");
  if (options.bounces < 0) throw Error("light cannot bounce less than 0 times");
  if (options.bounces > 0 && !reflects_light(options.method)) {
    throw Error(
        fmt::format("{} does not trace what surfaces receive from each other; leave --bounces, or use auto, mc, "
                    "pixels, importance, structured, mis or cache",
                    name_of(options.method)));
  }
  check_depth_maps(options);
  Rendering result;
  const bool few_rays = options.method == RenderMethod::kSh;
  const Tracer tracer(scene, few_rays ? Tracer::Effort::kFewRays : Tracer::Effort::kManyRays);
  Setting setting{scene, tracer, light, options, tracer.convex()};
  const MethodChoice choice = choose_method(setting);
  result.method = choice.method;
  result.method_reason = choice.reason;
  setting.sh_degree = choice.sh_degree;
  Painting painting(setting, choice.method);
  paint(painting, scene, options);
  if (options.method == RenderMethod::kAuto && choice.method == RenderMethod::kSh && painting.saw_backs()) {
    // The choice was made for what is seen from outside.
    result.rays = painting.rays();
    result.method = RenderMethod::kMis;
    result.method_reason = "surfaces are seen from behind, where the scene is in the way of the light";
    Painting again(setting, result.method);
    paint(again, scene, options);
    finish(again, scene, result);
    return result;
  }
  finish(painting, scene, result);
  if (setting.convex && !painting.exact() && !painting.saw_backs() && options.depth_maps == 0)
    result.skipped = "shadow rays: the scene is convex, nothing can occlude; error 0";
  if (options.method == RenderMethod::kAuto && choice.method == RenderMethod::kSh) result.skipped = choice.skipped;
  return result;
}

}  // namespace hdr
