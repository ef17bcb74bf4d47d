// Test renders: time against error of every method, CPU seconds of hierarchy and render, both cores added; Embree's raw
// rate of the same rays beside.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "libhdr/render/render.h"
#include "libhdr/render/scene_file.h"
#include "tests/bench/render_scene.h"
#include "tests/bench/render_targets.h"
#include "tests/bench/stopwatch.h"
#include "tests/support/support.h"

namespace hdr::bench {
namespace {

bool all_met = true;

const char* verdict(bool met) {
  all_met = all_met && met;
  return met ? "met" : "MISSED";
}

struct Timed {
  Rendering rendering;
  double cpu = 0;
};

Timed timed(const Scene& scene, const Environment& light, const RenderOptions& options) {
  const Stopwatch watch;
  Rendering rendering = render(scene, light, options);
  return {std::move(rendering), watch.elapsed().cpu};
}

struct Options {
  std::string scene, map, only, save;
  Size size{400, 300};
  int reference = 1024;
  bool quick = false, strict = false;
};

Scene scene_of(const Options& options) {
  if (options.scene.empty()) return folded_ball_on_plane();
  return mesh_on_plane(joined(read_scene(options.scene, {Shading::kFlat}).scene), 60000);
}

Image<float> map_of(const Options& options) {
  if (options.map.empty()) return sunny_sky(1024);
  const RadianceMap map = read_map(options.map).map;
  return map.rgb.clone();
}

Vec3f brightest(View<const float> map) {
  int at_x = 0, at_y = 0;
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x)
      if (map(x, y, 1) > map(at_x, at_y, 1)) at_x = x, at_y = y;
  return dir_from_latlong((at_x + 0.5) / map.width(), (at_y + 0.5) / map.height()).cast<float>();
}

void bench_rates(const Options& options, const Scene& scene, View<const float> map) {
  const Vec3f sun = brightest(map);
  const int rays = options.quick ? 16 : 256;
  const RawRates raw = raw_embree_rates(scene, options.size, sun, rays);
  fmt::print("Embree alone: {:.1f} M AO rays, {:.1f} M sun rays a CPU s; hierarchy {:.3f} CPU s; {:.0f} pixels hit\n",
             raw.ao / 1e6, raw.sun / 1e6, raw.build_seconds, raw.hits);
  const Environment sky(sunny_sky(64));
  const Timed ao = timed(scene, sky, {RenderMethod::kAo, options.size, rays, 1});
  const double ao_rate = static_cast<double>(ao.rendering.rays) / ao.cpu;
  fmt::print("AO-{}: {:.2f} CPU s (must: <= 2.2 with 256) {}, {:.1f} M rays/s, {:.0f} % of raw (must: >= 60) {}\n",
             rays, ao.cpu, verdict(ao.cpu <= 2.2), ao_rate / 1e6, 100 * ao_rate / raw.ao,
             verdict(ao_rate >= 0.6 * raw.ao));
  // A sun alone: every direction is the sun's.
  Image<float> only_sun(1024, 512, 3);
  const Vec2 at = latlong_from_dir(sun.cast<double>());
  for (int c = 0; c < 3; ++c) only_sun(static_cast<int>(at.x() * 1024), static_cast<int>(at.y() * 512), c) = 1e5f;
  const Environment sun_light(std::move(only_sun));
  const Timed shadows = timed(scene, sun_light, {RenderMethod::kImportance, options.size, rays, 1});
  const double sun_rate = static_cast<double>(shadows.rendering.rays) / shadows.cpu;
  fmt::print("sun shadows, {} a pixel: {:.2f} CPU s, {:.1f} M rays/s, {:.0f} % of raw (must: >= 60) {}\n", rays,
             shadows.cpu, sun_rate / 1e6, 100 * sun_rate / raw.sun, verdict(sun_rate >= 0.6 * raw.sun));
  std::fflush(stdout);
}

struct Row {
  RenderMethod method;
  int samples;
};

void bench_errors(const Options& options, const Scene& scene, const Image<float>& map) {
  const Environment plain(map.clone()), compensated(map.clone(), Environment::Density::kCompensated);
  const Timed truth = timed(scene, compensated, {RenderMethod::kMis, options.size, options.reference, 4711});
  fmt::print("reference: mis, {} samples, {:.1f} CPU s, estimated error {:.2f} %\n", options.reference, truth.cpu,
             100 * truth.rendering.estimated_error);
  if (!options.save.empty()) write_map(options.save, truth.rendering.picture);
  std::vector<Row> rows;
  for (const int samples : {8, 16, 32, 64, 128, 256}) {
    for (const RenderMethod method : {RenderMethod::kStructured, RenderMethod::kMis, RenderMethod::kAuto})
      rows.push_back({method, samples});
  }
  rows.push_back({RenderMethod::kImportance, 64});
  rows.push_back({RenderMethod::kMc, 64});
  rows.push_back({RenderMethod::kSh, 8});
  fmt::print("  method      samples  CPU s   relRMSE  estimated  M rays/s\n");
  for (const Row& row : rows) {
    const bool both = row.method == RenderMethod::kMis || row.method == RenderMethod::kAuto;
    const Timed one = timed(scene, both ? compensated : plain, {row.method, options.size, row.samples, 1});
    fmt::print("  {:<11} {:6d} {:7.3f} {:8.2f} % {:8.2f} % {:6.1f}\n", name_of(row.method), row.samples, one.cpu,
               100 * rel_rmse(one.rendering.picture.rgb, truth.rendering.picture.rgb, truth.rendering.picture.alpha),
               100 * one.rendering.estimated_error, static_cast<double>(one.rendering.rays) / one.cpu / 1e6);
    std::fflush(stdout);
  }
}

int main(int argc, char** argv) {
  Options options;
  CLI::App app("  render_bench\n\ntest renders: time against error");
  app.add_flag("--quick", options.quick, "few rays: answers, not times");
  app.add_flag("--strict", options.strict, "exit 1 when a figure is missed");
  app.add_option("--scene", options.scene, "a mesh instead of the folded ball");
  app.add_option("--map", options.map, "a lat-long instead of the sunny sky");
  app.add_option("--reference", options.reference, "samples of the reference")->capture_default_str();
  app.add_option("--only", options.only, "rates, errors, targets or triangles");
  app.add_option("--save", options.save, "write the reference here (.exr)");
  CLI11_PARSE(app, argc, argv);
  if (options.quick) options.size = {80, 60}, options.reference = 64;
  const auto wanted = [&](const char* part) { return options.only.empty() || options.only == part; };
  const Scene scene = scene_of(options);
  const Image<float> map = map_of(options);
  if (wanted("rates")) bench_rates(options, scene, map);
  if (wanted("errors")) bench_errors(options, scene, map);
  if (wanted("targets")) all_met = bench_targets({scene, map, options.size, options.quick}) && all_met;
  if (wanted("triangles")) bench_triangles(options.quick);
  return all_met || !options.strict ? 0 : 1;
}

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) try { return hdr::bench::main(argc, argv); } catch (const std::exception& e) {
  fmt::print(stderr, "render_bench: {}\n", e.what());
  return 1;
}
