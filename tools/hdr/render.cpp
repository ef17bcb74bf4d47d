#include "libhdr/render/render.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"
#include "tools/hdr/scene_input.h"

namespace hdr::tools {
namespace {

struct Options {
  ProbeInput probe;
  SceneInput scene;
  std::string output, method = "auto", size = "640x480";
  int samples = 64;
  std::uint64_t seed = 1;
  WriteFlags write;
};

}  // namespace

std::function<int(Run&)> declare_render(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->probe.declare(app, false);
  app.add_option("-o,--output", options->output, "the picture (.exr, RGBA: alpha is coverage)")->required();
  options->scene.declare(app);
  app.add_option("--method", options->method, "auto, mc, importance, structured, mis, ao, sh or prt")
      ->check(CLI::IsMember({"auto", "mc", "importance", "structured", "mis", "ao", "sh", "prt"}))
      ->capture_default_str();
  app.add_option("--samples", options->samples, "a pixel")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  app.add_option("--size", options->size, "of the picture")->capture_default_str();
  app.add_option("--seed", options->seed, "of the random numbers")->capture_default_str();
  options->write.declare(app);
  return [options](Run& run) {
    const RenderMethod method = render_method_from_name(options->method).value();
    RenderOptions settings{method, size_from_text(options->size, "--size"), options->samples, options->seed, {}, {}};
    SceneInput::Loaded loaded = run.stage("scene", [&] { return options->scene.read(run, settings.size); });
    settings.transfer = std::move(loaded.transfer);
    const Scene& scene = loaded.scene;
    const Probe probe = options->probe.read(run);
    // Both samplers together reach every direction: the probe's may leave the dim ones to the surface's [Karlik19].
    const bool both = method == RenderMethod::kMis || method == RenderMethod::kAuto;
    const auto density = both ? Environment::Density::kCompensated : Environment::Density::kLuminance;
    const Environment light =
        run.stage("tables", [&] { return Environment::from_probe(probe.map, probe.projection, 0, density); });
    const Rendering result = run.stage("render", [&](const Progress& progress) {
      settings.progress = [&progress](double done) { progress.update(done); };
      return render(scene, light, settings);
    });
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
    run.stage("write", [&] {
      write_map(options->output, result.picture, provenance_of(run, options->probe.path), options->write.options());
    });
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
