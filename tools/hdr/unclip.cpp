#include <fmt/format.h>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/io/write.h"
#include "libhdr/light/diffuse_ball.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/horizontal_irradiance.h"
#include "libhdr/light/restore_clipped.h"
#include "tools/hdr/image_input.h"
#include "tools/hdr/options.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"
#include "tools/hdr/unwrap_step.h"

namespace hdr::tools {
namespace {

struct Options {
  ProbeInput probe;
  std::string output;
  std::optional<double> target_lux;
  std::vector<std::string> measured;
  std::string diffuse_ball, albedo = "auto";
  UnwrapFlags camera;  ///< --ball, --distance, --camera-fov and --rotate of the diffuse ball
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
  app.add_option("--diffuse-ball", diffuse_ball,
                 "the map of a matt ball in the same light (a bracket of it, merged), taken from where the mirror ball "
                 "was: each of its normals is a light meter");
  app.add_option("--albedo", albedo, "of the diffuse ball: A or R,G,B; or auto: one unknown, read from its unlit side")
      ->capture_default_str();
  app.add_option("--ball", camera.ball, "the diffuse ball in its map: CX,CY,R in pixels (y down), or auto")
      ->capture_default_str();
  app.add_option("--distance", camera.distance, "from the camera to the diffuse ball's centre, in ball radii");
  app.add_option("--camera-fov", camera.camera_fov,
                 "horizontal field of the whole photograph of the diffuse ball, degrees: gives its distance")
      ->check(CLI::Range(1.0, 179.0));
  app.add_option("--rotate", camera.rotate,
                 "turn of the diffuse ball's axes into the probe's, degrees X,Y,Z, as in unwrap: d_out = Rz Ry Rx d_in")
      ->capture_default_str();
  app.add_option("--level", level,
                 "pixels that reach it in a channel are clipped (default: 98 % of the largest sample)")
      ->check(CLI::PositiveNumber);
}

// --albedo; nothing when it is to be found.
std::optional<Rgb> albedo_of(const std::string& text) {
  if (text == "auto") return std::nullopt;
  const bool grey = text.find(',') == std::string::npos;
  const Rgb albedo = vec3_from_text(grey ? text + "," + text + "," + text : text, "--albedo").array();
  if (!(albedo > 0).all() || !(albedo <= 1).all())
    throw Error("--albedo " + text + ": give what the ball reflects, above 0 and at most 1, or auto");
  return albedo;
}

void add_ball(Run& run, const Options& options, std::vector<MeasuredIrradiance>& list) {
  const std::optional<Rgb> albedo = albedo_of(options.albedo);
  const Mat3 probe_from_camera = rotation_from_degrees(vec3_from_text(options.camera.rotate, "--rotate"));
  const RadianceMap picture = read_image(run, options.diffuse_ball);
  const MirrorBall ball = ball_geometry(run, picture, options.camera, options.diffuse_ball).ball;
  const BallReadings result =
      run.stage("ball", [&] { return read_diffuse_ball(picture.rgb, ball, albedo.value_or(Rgb::Ones())); });
  constexpr std::size_t kFewest = 50;
  if (result.readings.size() < kFewest) {
    throw Error(
        fmt::format("{}: the ball (centre {:.0f}, {:.0f}, radius {:.0f} px) shows light at {} of its normals, "
                    "too few; pass --ball CX,CY,R, or a larger picture of it",
                    options.diffuse_ball, ball.disc.cx, ball.disc.cy, ball.disc.r, result.readings.size()));
  }
  if (result.unusable > result.pixels / 100) {
    run.warn(fmt::format("{}: {} pixels of the ball are black or not finite and were left out", options.diffuse_ball,
                         result.unusable));
  }
  run.answer["ball"] = {{"cx", ball.disc.cx}, {"cy", ball.disc.cy}, {"r", ball.disc.r}};
  run.answer["ball"]["distance"] = std::isfinite(ball.distance) ? Json(ball.distance) : Json(nullptr);
  run.answer["readings"] = result.readings.size();
  for (const MeasuredIrradiance& m : result.readings)
    list.push_back({(probe_from_camera * m.normal).normalized(), m.irradiance});
}

std::vector<MeasuredIrradiance> measurements(Run& run, const Options& options, const RadianceMap& map,
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
  if (!options.diffuse_ball.empty()) {
    // A factor that is unknown for the ball's readings would be one for the others as well.
    if (!list.empty() && options.albedo == "auto")
      throw Error("--diffuse-ball beside other readings: pass --albedo, so that all are in one unit");
    add_ball(run, options, list);
  }
  if (list.empty()) throw Error("no irradiance was measured; pass --target-lux, --diffuse-ball or --measured");
  return list;
}

void report(Run& run, const Options& options, const Restored& result, bool found_albedo) {
  run.answer["regions"] = result.regions;
  run.answer["gains"] = Json::array();
  run.answer["gain_deviations"] = Json::array();
  for (const Rgb& gain : result.gains) run.answer["gains"].push_back({gain[0], gain[1], gain[2]});
  for (const Rgb& d : result.deviations) run.answer["gain_deviations"].push_back({d[0], d[1], d[2]});
  run.answer["residual"] = {result.residual[0], result.residual[1], result.residual[2]};
  run.say(fmt::format("{} clipped regions; the first grew {:.3g} times; residual {:.2g} of what was measured",
                      result.regions, result.gains[0].maxCoeff(), result.residual.maxCoeff()));
  if (result.residual.maxCoeff() > 0.05) {
    run.warn(fmt::format("{}: the probe with its clipped pixels restored is still {:.0f} % off what was measured",
                         options.probe.path.string(), 100 * result.residual.maxCoeff()));
  }
  if (!found_albedo) return;
  const double doubt = result.scale_deviation / result.scale;
  run.answer["albedo"] = 1 / result.scale;
  run.answer["albedo_deviation"] = doubt / result.scale;
  run.say(fmt::format("albedo of the ball: {:.3g} +- {:.2g}", 1 / result.scale, doubt / result.scale));
  if (doubt > 0.1 || 1 / result.scale > 1.05) {
    run.warn(
        fmt::format("{}: the ball's albedo comes out as {:.3g} +- {:.2g}; pass --albedo, and both maps in one unit",
                    options.diffuse_ball, 1 / result.scale, doubt / result.scale));
  }
}

}  // namespace

std::function<int(Run&)> declare_unclip(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->declare(app);
  return [options](Run& run) {
    Probe probe = options->probe.read(run);
    const Image<float> latlong = run.stage("lat-long", [&] { return latlong_from_probe(probe.map, probe.projection); });
    const auto measured = measurements(run, *options, probe.map, latlong);
    const bool find_albedo = !options->diffuse_ball.empty() && options->albedo == "auto";
    Restored result = run.stage("restore", [&] {
      return restore_clipped(latlong, clipped_mask(latlong, options->level), measured, {find_albedo});
    });
    report(run, *options, result, find_albedo);
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
