#include "tests/bench/render_targets.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "tests/bench/peak_memory.h"
#include "tests/bench/render_scene.h"
#include "tests/bench/row.h"
#include "tests/bench/stopwatch.h"

namespace hdr::bench {
namespace {

struct Timed {
  Rendering rendering;
  double cpu = 0;  ///< of hierarchy and render, both cores added
};

class Figures {
 public:
  explicit Figures(const RenderTargets& targets)
      : targets_(targets),
        sunny_(targets.sunny.clone(), Environment::Density::kCompensated),
        plain_(targets.sunny.clone()),
        soft_(soft_sky(targets.sunny.width())) {}

  bool all_met() const { return all_met_; }

  void errors_under_the_sun() {
    const Rendering truth = of(sunny_, RenderMethod::kMis, targets_.size, most(4096), 4711).rendering;
    fmt::print("sunny, {}: reference of {} samples, estimated error {:.2f} %\n", "auto", most(4096),
               100 * truth.estimated_error);
    struct Target {
      double percent, seconds;
    };
    for (const Target& target : {Target{8, 0.45}, {5, 0.9}, {3.3, 3}, {1, INFINITY}})
      reach(sunny_, truth, target.percent, target.seconds);
  }

  void cache_under_a_soft_sky() {
    const Rendering truth = of(soft_, RenderMethod::kMis, targets_.size, most(16384), 4711).rendering;
    const Timed mc = of(soft_, RenderMethod::kMc, targets_.size, most(2500), 1);
    const double goal = error_of(mc.rendering, truth);
    say(fmt::format("soft, mc, {} samples: error {:.2f} %", most(2500), 100 * goal), mc.cpu, 21);
    for (int samples = 8; samples <= most(1024); samples *= 2) {
      const Timed cached = of(soft_, RenderMethod::kCache, targets_.size, samples, 1);
      const double error = error_of(cached.rendering, truth);
      fmt::print("  cache, {} samples: error {:.2f} %, estimated {:.2f} %, {} records, {:.2f} CPU s\n", samples,
                 100 * error, 100 * cached.rendering.estimated_error, cached.rendering.cache_points.size(), cached.cpu);
      if (error > goal) continue;
      say(fmt::format("soft, cache, error {:.2f} %", 100 * error), cached.cpu, 1.6);
      return;
    }
    say("soft, cache, as good as mc", INFINITY, 1.6);
  }

  void others() {
    for (int k = 0; k < 2; ++k)  // the first of a process waits for its threads
      if (const Timed sh = of(plain_, RenderMethod::kSh, targets_.size, 1, 1); k == 1) say("sh", sh.cpu, 0.05);
    const Timed ao = of(plain_, RenderMethod::kAo, targets_.size, most(256), 1);
    say(fmt::format("ao, {} rays", most(256)), ao.cpu, 2.2);
    const Timed sh_ao = of(plain_, RenderMethod::kShAo, targets_.size, most(256), 1);
    say(fmt::format("sh-ao, {} rays, against ao", most(256)), sh_ao.cpu, 1.1 * ao.cpu);
    Scene shiny = targets_.scene;
    for (Mesh& mesh : shiny.meshes) mesh.material = {MaterialKind::kGgx, Rgbf::Constant(0.5f), 0.3f};
    std::swap(scene_, shiny);
    const Rendering truth = of(sunny_, RenderMethod::kMis, targets_.size, most(4096), 4711).rendering;
    reach(sunny_, truth, 10, 2);
    std::swap(scene_, shiny);
  }

  void large() {
    const Size size = targets_.quick ? Size{96, 54} : Size{1920, 1080};
    const Rendering truth = of(sunny_, RenderMethod::kMis, size, most(1024), 4711).rendering;
    reach(sunny_, truth, 5, 12);
  }

 private:
  static Image<float> soft_sky(int width) {
    Image<float> map = sunny_sky(width);
    for (int y = 0; y < map.height(); ++y)
      for (int k = 0; k < 3 * width; ++k) map.row(y)[k] = std::min(map.row(y)[k], 3.0f);
    return map;
  }

  int most(int samples) const { return targets_.quick ? std::min(samples, 64) : samples; }

  Timed of(const Environment& light, RenderMethod method, Size size, int samples, std::uint64_t seed) const {
    const Stopwatch watch;
    Rendering rendering = render(scene_, light, {method, size, samples, seed});
    return {std::move(rendering), watch.elapsed().cpu};
  }

  static double error_of(const Rendering& r, const Rendering& truth) {
    return rel_rmse(r.picture.rgb, truth.picture.rgb, truth.picture.alpha);
  }

  // The fewest samples, in steps of an eighth, that reach an error.
  void reach(const Environment& light, const Rendering& truth, double percent, double seconds) {
    const Size size = truth.picture.rgb.size();
    for (double samples = 8; samples <= most(8192); samples *= 1.125) {
      const Timed one = of(light, RenderMethod::kAuto, size, static_cast<int>(samples), 1);
      const double error = 100 * error_of(one.rendering, truth);
      // Errors fall as the root of the work or faster: far from there, larger steps.
      if (error > 1.5 * percent) samples *= std::max(1.0, 0.5 * std::pow(error / percent, 2));
      if (error > percent) continue;
      say(fmt::format("{}x{}, auto, {} samples: error {:.2f} %, estimated {:.2f} %", size.width, size.height,
                      static_cast<int>(samples), error, 100 * one.rendering.estimated_error),
          one.cpu, seconds);
      return;
    }
    say(fmt::format("{}x{}, auto to {} %", size.width, size.height, percent), INFINITY, seconds);
  }

  void say(const std::string& what, double cpu, double must) {
    const bool met = std::isfinite(cpu) && cpu <= must;
    all_met_ = all_met_ && met;
    fmt::print("{}: {:.3f} CPU s (must: <= {:.2f}) {}\n", what, cpu, must, met ? "met" : "MISSED");
    std::fflush(stdout);
  }

  const RenderTargets& targets_;
  Scene scene_ = targets_.scene;
  Environment sunny_, plain_, soft_;
  bool all_met_ = true;
};

}  // namespace

bool bench_targets(const RenderTargets& targets) {
  Figures figures(targets);
  figures.errors_under_the_sun();
  figures.others();
  figures.cache_under_a_soft_sky();
  figures.large();
  return figures.all_met();
}

void bench_triangles(bool quick) {
  const int segments = quick ? 100 : 3163;
  const Scene scene = folded_ball_on_plane(segments);
  std::size_t triangles = 0;
  for (const Mesh& mesh : scene.meshes) triangles += mesh.indices.size() / 3;
  const Environment light(sunny_sky(256), Environment::Density::kCompensated);
  const PeakMemory peak;
  const Stopwatch watch;
  const Rendering r = render(scene, light, {RenderMethod::kAuto, {400, 300}, 16, 1});
  fmt::print(
      "{} triangles: auto, 16 samples, {:.2f} CPU s with its hierarchy, {} beyond the mesh; estimated error "
      "{:.1f} %\n",
      triangles, watch.elapsed().cpu, short_bytes(peak.bytes()), 100 * r.estimated_error);
}

}  // namespace hdr::bench
