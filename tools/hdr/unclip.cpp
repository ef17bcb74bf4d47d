#include <fmt/format.h>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/io/write.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/horizontal_irradiance.h"
#include "libhdr/light/restore_clipped.h"
#include "tools/hdr/options.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"

namespace hdr::tools {
namespace {

struct Options {
  ProbeInput probe;
  std::string output;
  std::optional<double> target_lux;
  std::vector<std::string> measured;
  double level = 0;

  void declare(CLI::App& app);
};

void Options::declare(CLI::App& app) {
  probe.declare(app, true);
  app.add_option("-o,--output", output, "the probe with its suns restored: a lat-long, .exr")->required();
  app.add_option("--target-lux", target_lux,
                 "what a lux meter lying flat beside the probe read; the probe must know its cd/m^2 (whiteLuminance)")
      ->check(CLI::PositiveNumber);
  app.add_option(
      "--measured", measured,
      "X,Y,Z=R,G,B: irradiance at a normal, in the probe's unit; of a diffuse ball pi times its radiance over "
      "its albedo; may be given several times");
  app.add_option("--level", level,
                 "pixels that reach it in a channel are clipped (default: 98 % of the largest sample)")
      ->check(CLI::PositiveNumber);
}

std::vector<MeasuredIrradiance> measurements(const Options& options, const RadianceMap& map,
                                             View<const float> latlong) {
  std::vector<MeasuredIrradiance> list;
  if (options.target_lux) {
    if (!map.white_luminance) {
      throw Error(options.probe.path.string() +
                  ": does not know its cd/m^2 (no whiteLuminance), so lux mean nothing; make the probe with --lux, "
                  "--patch or from EXIF, or pass --measured");
    }
    // Lux are luminance: the colour of the light is that of the clipped pixels, all three channels grow alike.
    const Rgb e = horizontal_irradiance(latlong);
    const double now = luminance(e[0], e[1], e[2]) * *map.white_luminance;
    if (!(now > 0)) throw Error(options.probe.path.string() + ": is black from above; there is no sun to restore");
    list.push_back({Vec3::UnitY(), e});
    list.back().irradiance *= *options.target_lux / now;
  }
  for (const std::string& text : options.measured) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw Error("--measured " + text + ": give X,Y,Z=R,G,B");
    const Vec3 normal = vec3_from_text(text.substr(0, equals), "--measured");
    const Vec3 rgb = vec3_from_text(text.substr(equals + 1), "--measured");
    if (!(normal.norm() > 0) || !(rgb.minCoeff() > 0)) throw Error("--measured " + text + ": needs a normal and light");
    list.push_back({normal.normalized(), rgb.array()});
  }
  if (list.empty()) throw Error("no irradiance was measured; pass --target-lux or --measured");
  return list;
}

}  // namespace

std::function<int(Run&)> declare_unclip(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->declare(app);
  return [options](Run& run) {
    Probe probe = options->probe.read(run);
    const Image<float> latlong = run.stage("lat-long", [&] { return latlong_from_probe(probe.map, probe.projection); });
    const auto measured = measurements(*options, probe.map, latlong);
    Restored result =
        run.stage("restore", [&] { return restore_clipped(latlong, clipped_mask(latlong, options->level), measured); });
    run.answer["regions"] = result.regions;
    run.answer["gains"] = Json::array();
    for (const Rgb& gain : result.gains) run.answer["gains"].push_back({gain[0], gain[1], gain[2]});
    run.answer["residual"] = {result.residual[0], result.residual[1], result.residual[2]};
    run.say(fmt::format("{} clipped regions; the first grew {:.3g} times; residual {:.2g} of what was measured",
                        result.regions, result.gains[0].maxCoeff(), result.residual.maxCoeff()));
    if (result.residual.maxCoeff() > 0.05) {
      run.warn(fmt::format("{}: the probe with its clipped pixels restored is still {:.0f} % off what was measured",
                           options->probe.path.string(), 100 * result.residual.maxCoeff()));
    }
    RadianceMap map;
    map.rgb = std::move(result.rgb);
    map.chromaticities = probe.map.chromaticities;
    map.white_luminance = probe.map.white_luminance;
    map.projection = LatLong::kName;
    run.stage("write", [&] {
      write_map(options->output, map, provenance_of(run, options->probe.path), {SampleType::kFloat, "zip"});
    });
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
