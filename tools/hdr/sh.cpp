#include "libhdr/light/sh.h"

#include <fmt/format.h>

#include <charconv>

#include "libhdr/core/sphere.h"
#include "libhdr/io/output_file.h"
#include "libhdr/light/cube.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/sh_fit.h"
#include "libhdr/light/sh_text.h"
#include "libhdr/light/sh_window.h"
#include "tools/hdr/cube_output.h"
#include "tools/hdr/options.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"

namespace hdr::tools {
namespace {

struct Options {
  ProbeInput probe;
  std::string degree = "2", fit = "projection", window = "none", rotate = "0,0,0", output, format = "json",
              irradiance_output;
  double error = 0.01;
  bool cube = false;
  int width = 256;

  void declare(CLI::App& app);
};

std::string problem_of_degree(const std::string& text) {
  int degree = -1;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), degree);
  const bool whole = failed == std::errc() && end == text.data() + text.size();
  if (text == "auto" || (whole && degree >= 0 && degree <= kMaxShDegree)) return {};
  return fmt::format("{} is neither auto nor a degree from 0 to {}", text, kMaxShDegree);
}

void Options::declare(CLI::App& app) {
  probe.declare(app, true);
  app.add_option("--degree", degree, "highest degree (2 gives nine coefficients), or auto: the lowest within --error")
      ->check(problem_of_degree)
      ->capture_default_str();
  app.add_option("--error", error, "with --degree auto: of the irradiance, relative to its largest value")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  app.add_option("--fit", fit,
                 "projection: least error of the radiance on average; irradiance: least largest error of the "
                 "irradiance over all normals (degree 0 to 12, not auto)")
      ->check(CLI::IsMember({"projection", "irradiance"}))
      ->capture_default_str();
  app.add_option("--window", window,
                 "against ringing: none, hann, lanczos, or auto: as little as leaves no irradiance negative")
      ->check(CLI::IsMember({"none", "hann", "lanczos", "auto"}))
      ->capture_default_str();
  app.add_option("--rotate", rotate, "turns the light, degrees X,Y,Z: d_out = Rz Ry Rx d_in")->capture_default_str();
  app.add_option("-o,--output", output, "write the numbers");
  app.add_option("--format", format,
                 "of -o: json, c (a header), threejs (27 numbers), filament or unity (E/pi as a polynomial)")
      ->check(CLI::IsMember({"json", "c", "threejs", "filament", "unity"}))
      ->capture_default_str();
  app.add_option("--irradiance-map", irradiance_output, "write the irradiance as a lat-long map");
  app.add_option("--width", width, "width of the irradiance map")->check(CLI::Range(1, 16384))->capture_default_str();
  app.add_flag("--cube", cube, "the irradiance map as a folder of six faces, px.exr to nz.exr, WIDTH pixels wide");
}

Json triple(const Rgb& c) {
  return Json::array({c[0], c[1], c[2]});
}

Json matrices_of(const Sh& sh) {
  Json matrix;
  const char* channel_names[] = {"R", "G", "B"};
  const auto matrices = irradiance_matrices(sh);
  for (std::size_t c = 0; c < 3; ++c) {
    Json numbers = Json::array();
    for (int k = 0; k < 16; ++k) numbers.push_back(matrices[c](k / 4, k % 4));
    matrix[channel_names[c]] = std::move(numbers);
  }
  return matrix;
}

// The expansion that was asked for, before it is turned, and its bound in the answer.
Sh expansion(Run& run, const Options& options, const Probe& probe) {
  const View<const float> rgb = probe.map.rgb;
  ChosenSh chosen;
  if (options.fit == "irradiance") {
    const int degree = std::stoi(options.degree);
    const FittedSh fitted =
        run.stage("fit", [&] { return fit_irradiance(latlong_from_probe(probe.map, probe.projection), degree); });
    run.answer["fit_error"] = fitted.error;
    run.answer["projection_error"] = fitted.projected;
    run.say(
        fmt::format("largest error of the irradiance over all normals: {:.2f} % of its largest value; of the "
                    "projection {:.2f} %",
                    100 * fitted.error, 100 * fitted.projected));
    chosen.sh = fitted.sh;
  } else if (options.degree == "auto") {
    chosen = run.stage("sh", [&] { return project_within(rgb, probe.projection, options.error); });
    if (!chosen.met) {
      run.warn(
          fmt::format("{}: degree {} is within {:.2g} of the irradiance, not within {:g}; it has the most degrees "
                      "that are tried",
                      options.probe.path.string(), chosen.sh.degree, chosen.bound, options.error));
    } else if (chosen.sh.degree < 12) {
      run.clock.skipped(
          fmt::format("degrees above {}: the probe has no energy there that changes irradiance by more "
                      "than {:.2g} of its largest value",
                      chosen.sh.degree, chosen.bound));
    }
  } else {
    chosen.sh = run.stage("sh", [&] { return project(rgb, probe.projection, std::stoi(options.degree)); });
  }
  const WindowedSh result = windowed(chosen.sh, sh_window_from_name(options.window).value());
  run.answer["degree"] = result.sh.degree;
  run.answer["window"] = options.window;
  run.answer["window_factors"] = result.factors;
  run.answer["error_bound"] =
      run.stage("bound", [&] { return irradiance_error_bound(rgb, probe.projection, result.sh); });
  return result.sh;
}

void write_irradiance_map(Run& run, const Options& options, const Probe& probe, const Sh& sh) {
  const Provenance provenance = provenance_of(run, options.probe.path);
  if (options.cube) {
    write_cube(options.irradiance_output,
               cube_map(options.width, [&](const Vec3& n) { return Rgb(irradiance(sh, n).max(0.0)); }), probe.map,
               provenance, {SampleType::kFloat, "zip"});
  } else {
    RadianceMap map;
    map.rgb = irradiance_map(sh, {options.width, std::max(1, options.width / 2)});
    map.projection = LatLong::kName;
    map.chromaticities = probe.map.chromaticities;
    write_map(options.irradiance_output, map, provenance, {SampleType::kFloat, "zip"});
  }
  run.say("wrote " + options.irradiance_output);
}

std::string text_in_format(const Run& run, const std::string& format, const Sh& sh) {
  if (format == "c") return text_of(sh, ShFormat::kC);
  if (format == "threejs") return text_of(sh, ShFormat::kThreeJs);
  if (format == "filament") return text_of(sh, ShFormat::kFilament);
  if (format == "unity") return text_of(sh, ShFormat::kUnity);
  return run.answer.dump(2) + "\n";
}

void say_coefficients(const Run& run, const Sh& sh) {
  for (int l = 0; l <= sh.degree; ++l) {
    for (int m = -l; m <= l; ++m) {
      const Rgb& c = sh(l, m);
      run.say(fmt::format("L {:2d} {:+3d}   {:12.6g} {:12.6g} {:12.6g}", l, m, c[0], c[1], c[2]));
    }
  }
}

}  // namespace

std::function<int(Run&)> declare_sh(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->declare(app);
  return [options](Run& run) {
    if (options->fit == "irradiance" && (options->degree == "auto" || std::stoi(options->degree) > 12))
      throw CLI::ValidationError("--fit", "irradiance needs a --degree from 0 to 12");
    const Mat3 rotation = rotation_from_degrees(vec3_from_text(options->rotate, "--rotate"));
    const Probe probe = options->probe.read(run);
    const Sh sh = rotated(expansion(run, *options, probe), rotation);
    Json coefficients = Json::array();
    for (const Rgb& c : sh.coefficients) coefficients.push_back(triple(c));
    run.answer["coefficients"] = coefficients;
    run.answer["irradiance_matrix"] = matrices_of(sh);
    const Rgb least = least_irradiance(sh);
    run.answer["least_irradiance"] = triple(least);
    if (!options->output.empty()) {
      write_text(options->output, text_in_format(run, options->format, sh));
      run.say("wrote " + options->output);
    }
    if (!options->irradiance_output.empty()) write_irradiance_map(run, *options, probe, sh);
    say_coefficients(run, sh);
    run.say(fmt::format("irradiance is within {:.2g} of its largest value (bound)",
                        run.answer["error_bound"].get<double>()));
    if ((least < 0).any() && options->window == "none") {
      run.say(fmt::format("it rings below zero, to {:.3g}; --window auto takes that away", least.minCoeff()));
    }
    return 0;
  };
}

}  // namespace hdr::tools
