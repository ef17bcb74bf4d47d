#include "libhdr/light/lights.h"

#include <fmt/format.h>

#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/lights_text.h"
#include "tools/hdr/probe_input.h"
#include "tools/hdr/strata_picture.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {
namespace {

struct Options {
  ProbeInput probe;
  std::string method = "structured", placement, output, picture;
  int count = 64;
  std::uint64_t seed = 1;

  void declare(CLI::App& app);
  LightsOptions settings() const;
};

void Options::declare(CLI::App& app) {
  probe.declare(app, true);
  app.add_option("-n,--count", count, "how many lights")->check(CLI::Range(1, 65536))->capture_default_str();
  app.add_option("--method", method, "median-cut, variance-cut, structured or kollig-keller")
      ->check(CLI::IsMember({"median-cut", "variance-cut", "structured", "kollig-keller"}))
      ->capture_default_str();
  app.add_option("--placement", placement,
                 "of a light in its region: centroid, matched (to the probe's irradiance), jittered (default: matched; "
                 "centroid for median-cut)")
      ->check(CLI::IsMember({"centroid", "matched", "jittered"}));
  app.add_option("--seed", seed, "of jittered")->capture_default_str();
  app.add_option("-o,--output", output, "write the lights: .json, .usda (USD) or .rad (Radiance)");
  app.add_option("--picture", picture, "write a picture of the regions over the map (.png, .jpg)");
}

LightsOptions Options::settings() const {
  LightsOptions result;
  result.count = count;
  result.method = lights_method_from_name(method).value();
  if (!placement.empty()) result.placement = light_placement_from_name(placement);
  result.seed = seed;
  return result;
}

Json numbers(const auto& three) {
  return Json::array({three[0], three[1], three[2]});
}

Json json_of(const std::vector<DirectionalLight>& lights) {
  Json rows = Json::array();
  for (const DirectionalLight& light : lights) {
    rows.push_back({{"direction", numbers(light.direction)},
                    {"irradiance", numbers(light.irradiance)},
                    {"solid_angle", light.solid_angle}});
  }
  return rows;
}

std::string text_for(const Path& output, const Run& run, const std::vector<DirectionalLight>& lights) {
  const std::string extension = output.extension().string();
  if (extension == ".usda") return usd_of(lights);
  if (extension == ".rad") return rad_of(lights);
  if (extension == ".json") return run.answer.dump(2) + "\n";
  throw Error(output.string() + ": lights are written as .json, .usda or .rad; choose one of these");
}

}  // namespace

std::function<int(Run&)> declare_lights(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->declare(app);
  return [options](Run& run) {
    const Probe probe = options->probe.read(run);
    const Image<float> latlong = run.stage("lat-long", [&] { return latlong_from_probe(probe.map, probe.projection); });
    const Lights result = run.stage("lights", [&] { return make_lights(latlong, options->settings()); });
    const double error = run.stage("check", [&] { return irradiance_rms_error(result.lights, latlong); });
    run.answer["method"] = options->method;
    run.answer["irradiance_error"] = error;
    run.answer["lights"] = json_of(result.lights);
    if (static_cast<int>(result.lights.size()) < options->count) {
      run.warn(fmt::format("{}: {} lights, not {}: the map has no more pixels", options->probe.path.string(),
                           result.lights.size(), options->count));
    }
    run.say(
        fmt::format("{} lights; irradiance of all normals within {:.2g} % (rms)", result.lights.size(), 100 * error));
    if (!options->output.empty()) {
      write_text(options->output, text_for(options->output, run, result.lights));
      run.say("wrote " + options->output);
    }
    if (!options->picture.empty()) {
      run.stage("picture", [&] { write_picture(options->picture, strata_picture(latlong, result)); });
      run.say("wrote " + options->picture);
    }
    return 0;
  };
}

}  // namespace hdr::tools
