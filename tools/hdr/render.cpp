#include "libhdr/render/render.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/render/composite.h"
#include "libhdr/render/layers.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"
#include "tools/hdr/render_output.h"
#include "tools/hdr/report_probe.h"
#include "tools/hdr/scene_input.h"

namespace hdr::tools {
namespace {

struct Options {
  ProbeInput probe;
  SceneInput scene;
  RenderOutput output;
  std::string method = "auto", size = "640x480", filter = "box";
  std::optional<int> samples;
  double error = 0;
  int bounces = 0, depth_maps = 0;
  std::uint64_t seed = 1;
  ReportFlag report;
};

// The layers that are no by-product of the render.
Image<float> add_layers(Run& run, const RenderOutput& output, const Scene& scene, const Environment& light,
                        RenderOptions settings, Rendering& rendering) {
  if (output.wants("albedo") || output.wants("depth")) {
    SurfaceLayers layers = run.stage("layers", [&] { return surface_layers(scene, settings); });
    rendering.albedo = std::move(layers.albedo);
    rendering.depth = std::move(layers.depth);
  }
  if (!output.wants("ao") || settings.method == RenderMethod::kAo) return {};
  settings.method = RenderMethod::kAo;
  settings.transfer.clear();
  settings.progress = nullptr;
  settings.bounces = 0;
  settings.backdrop = false;
  if (settings.error > 0) settings.samples = 256, settings.error = 0;  // the error asked for is the picture's
  return run.stage("ao", [&] { return std::move(render(scene, light, settings).picture.rgb); });
}

}  // namespace

std::function<int(Run&)> declare_render(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->probe.declare(app, false);
  options->output.declare(app);
  options->scene.declare(app);
  app.add_option("--method", options->method,
                 "auto (and says why), mc, pixels, importance, structured, mis, cache, ao, sh, sh-ao, mean-ao or prt")
      ->check(CLI::IsMember(
          {"auto", "mc", "pixels", "importance", "structured", "mis", "cache", "ao", "sh", "sh-ao", "mean-ao", "prt"}))
      ->capture_default_str();
  app.add_option(
         "--samples", options->samples,
         "directions a pixel (default 64); with auto the mean, half of it where it is needed; with --error the most "
         "a pixel may get (default 16384)")
      ->check(CLI::Range(1, 1 << 20));
  app.add_option("--error", options->error,
                 "render until the estimated relative error of each pixel is this small, say .02; nothing is spent on "
                 "pixels that are there")
      ->check(CLI::Range(1e-4, 1.0));
  app.add_option("--bounces", options->bounces,
                 "how often light goes from surface to surface before it is seen: diffuse interreflection, of all "
                 "methods but ao, sh, sh-ao, mean-ao and prt")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  app.add_option(
         "--depth-maps", options->depth_maps,
         "of ao, sh-ao and mean-ao: see the sky in so many depth maps from all around, as the lecture does, instead of "
         "by rays, which take no longer")
      ->check(CLI::Range(1, 1 << 16));
  app.add_option("--size", options->size, "of the picture")->capture_default_str();
  app.add_option("--filter", options->filter, "of the film: box is the pixel itself, blackman-harris three pixels wide")
      ->check(CLI::IsMember({"box", "blackman-harris"}))
      ->capture_default_str();
  app.add_option("--seed", options->seed, "of the random numbers")->capture_default_str();
  options->report.declare(app);
  return [options](Run& run) {
    options->report.check();
    const RenderMethod method = render_method_from_name(options->method).value();
    RenderOptions settings{method, size_from_text(options->size, "--size"), options->samples.value_or(64),
                           options->seed};
    settings.error = options->error;
    settings.bounces = options->bounces;
    settings.depth_maps = options->depth_maps;
    if (options->error > 0 && !options->samples) settings.samples = 16384;
    settings.filter = options->filter == "box" ? FilmFilter::kBox : FilmFilter::kBlackmanHarris;
    settings.backdrop = !options->output.transparent;
    options->output.check();
    SceneInput::Loaded loaded = run.stage("scene", [&] { return options->scene.read(run, settings.size); });
    settings.transfer = std::move(loaded.transfer);
    const Scene& scene = loaded.scene;
    const Probe probe = options->probe.read(run);
    // Both samplers together reach every direction: the probe's may leave the dim ones to the surface's [Karlik19].
    const bool both = method == RenderMethod::kMis || method == RenderMethod::kAuto;
    const auto density = both ? Environment::Density::kCompensated : Environment::Density::kLuminance;
    const Environment light =
        run.stage("tables", [&] { return Environment::from_probe(probe.map, probe.projection, 0, density); });
    Rendering result = run.stage("render", [&](const Progress& progress) {
      settings.progress = [&progress](double done) { progress.update(done); };
      return render_on_ground(scene, light, settings);
    });
    if (!result.method_reason.empty()) {
      run.answer["method_reason"] = result.method_reason;
      run.say(fmt::format("auto is {}: {}", name_of(result.method), result.method_reason));
    }
    if (!result.skipped.empty()) run.clock.skipped(result.skipped);
    const Stage& stage = run.clock.stages().back();
    run.answer["seconds"] = stage.seconds;
    run.answer["cpu_seconds"] = stage.cpu_seconds;
    run.answer["method"] = name_of(result.method);
    run.answer["rays"] = result.rays;
    run.answer["samples_per_pixel"] = result.samples_per_pixel;
    run.answer["estimated_error"] = result.estimated_error;
    run.say(fmt::format("{}: {} samples a pixel, {:.1f} M rays, estimated error {:.2g}", name_of(result.method),
                        result.samples_per_pixel, static_cast<double>(result.rays) / 1e6, result.estimated_error));
    const Image<float> openness = add_layers(run, options->output, scene, light, settings, result);
    options->output.save(run, result, openness.empty() ? result.picture.rgb.view() : openness.view(),
                         provenance_of(run, options->probe.path));
    if (options->report.wanted()) run.stage("report", [&] { write_render_report(options->report, run, result); });
    return 0;
  };
}

}  // namespace hdr::tools
