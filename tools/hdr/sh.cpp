#include "libhdr/light/sh.h"

#include <fmt/format.h>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/io/output_file.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"

namespace hdr::tools {
namespace {

Json triple(const Rgb& c) {
  return Json::array({c[0], c[1], c[2]});
}

/// The irradiance of the expansion, tabulated: the lecture's case without shaders.
RadianceMap irradiance_map(const Sh& sh, int width) {
  const Size size{width, std::max(1, width / 2)};
  RadianceMap map;
  map.rgb = Image<float>(size, 3);
  map.projection = LatLong::kName;
  for_rows(size.height, 4, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const Rgb e = irradiance(sh, dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height));
        for (int c = 0; c < 3; ++c) map.rgb(x, y, c) = static_cast<float>(std::max(0.0, e[c]));
      }
    }
  });
  return map;
}

}  // namespace

std::function<int(Run&)> declare_sh(CLI::App& app) {
  struct Options {
    ProbeInput probe;
    std::string output, irradiance_output;
    int degree = 2, width = 256;
  };
  auto options = std::make_shared<Options>();
  options->probe.declare(app, true);
  app.add_option("--degree", options->degree, "highest degree: 2 gives nine coefficients")
      ->check(CLI::Range(0, kMaxShDegree))
      ->capture_default_str();
  app.add_option("-o,--output", options->output, "write the numbers as JSON");
  app.add_option("--irradiance-map", options->irradiance_output, "write the irradiance as a lat-long map");
  app.add_option("--width", options->width, "width of the irradiance map")
      ->check(CLI::Range(1, 16384))
      ->capture_default_str();
  return [options](Run& run) {
    const Probe probe = options->probe.read(run);
    const Sh sh = run.stage("sh", [&] { return project(probe.map.rgb, probe.projection, options->degree); });
    const auto matrices = irradiance_matrices(sh);
    Json coefficients = Json::array();
    for (const Rgb& c : sh.coefficients) coefficients.push_back(triple(c));
    Json matrix;
    const char* channel_names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
      Json numbers = Json::array();
      for (int k = 0; k < 16; ++k) numbers.push_back(matrices[c](k / 4, k % 4));
      matrix[channel_names[c]] = std::move(numbers);
    }
    run.answer["degree"] = options->degree;
    run.answer["coefficients"] = coefficients;
    run.answer["irradiance_matrix"] = matrix;
    run.answer["error_bound"] =
        run.stage("bound", [&] { return irradiance_error_bound(probe.map.rgb, probe.projection, sh); });
    if (!options->output.empty()) {
      write_text(options->output, run.answer.dump(2) + "\n");
      run.say("wrote " + options->output);
    }
    if (!options->irradiance_output.empty()) {
      write_map(options->irradiance_output, irradiance_map(sh, options->width),
                provenance_of(run, options->probe.path));
      run.say("wrote " + options->irradiance_output);
    }
    for (int l = 0, k = 0; l <= options->degree; ++l) {
      for (int m = -l; m <= l; ++m, ++k) {
        const Rgb& c = sh.coefficients[static_cast<std::size_t>(k)];
        run.say(fmt::format("L {:2d} {:+3d}   {:12.6g} {:12.6g} {:12.6g}", l, m, c[0], c[1], c[2]));
      }
    }
    run.say(fmt::format("irradiance is within {:.2g} of its largest value (bound)",
                        run.answer["error_bound"].get<double>()));
    return 0;
  };
}

}  // namespace hdr::tools
