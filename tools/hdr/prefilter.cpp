#include "libhdr/light/prefilter.h"

#include <fmt/format.h>

#include "libhdr/light/cube.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/sh.h"
#include "tools/hdr/cube_output.h"
#include "tools/hdr/folder.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"

namespace hdr::tools {
namespace {

constexpr int kIrradianceWidth = 64, kIrradianceDegree = 12, kTableSize = 128;

struct Options {
  ProbeInput probe;
  std::string output, lobe = "ggx";
  int levels = 6, width = 256, samples = 512;
  bool cube = false;

  void declare(CLI::App& app);
  double roughness(int level) const { return levels > 1 ? static_cast<double>(level) / (levels - 1) : 0; }
  int level_width(int level) const { return std::max(cube ? 4 : 8, width >> level); }
};

void Options::declare(CLI::App& app) {
  probe.declare(app, true);
  app.add_option("-o,--output", output, "a folder for level_0.exr ..., irradiance.exr and brdf.exr")->required();
  app.add_option("--levels", levels, "roughnesses, evenly from 0 (a mirror) to 1; each level half as wide")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  app.add_option("--width", width, "of level 0, pixels")->check(CLI::Range(8, 16384))->capture_default_str();
  app.add_option("--lobe", lobe, "ggx (alpha = roughness^2) or phong (exponent 2 / alpha^2 - 2)")
      ->check(CLI::IsMember({"ggx", "phong"}))
      ->capture_default_str();
  app.add_option("--samples", samples, "directions a pixel")->check(CLI::Range(16, 65536))->capture_default_str();
  app.add_flag("--cube", cube, "every map as a folder of six faces, px.exr to nz.exr, instead of a lat-long");
}

class Writer {
 public:
  Writer(const Run& run, const Options& options, const Probe& probe)
      : options_(options), like_(probe.map), provenance_(provenance_of(run, options.probe.path)) {}

  void write_latlong(const std::string& name, Image<float> rgb) const {
    RadianceMap map;
    map.rgb = std::move(rgb);
    map.chromaticities = like_.chromaticities;
    map.projection = LatLong::kName;
    write_map(Path(options_.output) / (name + ".exr"), map, provenance_, kFloat);
  }
  void write_faces(const std::string& name, std::array<Image<float>, 6> faces) const {
    RadianceMap tags;
    tags.chromaticities = like_.chromaticities;
    write_cube(Path(options_.output) / name, std::move(faces), tags, provenance_, kFloat);
  }
  std::string path_of(const std::string& name) const {
    return (Path(options_.output) / (options_.cube ? name : name + ".exr")).string();
  }

  const WriteOptions kFloat{SampleType::kFloat, "zip"};

 private:
  const Options& options_;
  const RadianceMap& like_;
  Provenance provenance_;
};

void write_levels(Run& run, const Options& options, const Writer& writer, View<const float> latlong) {
  const Prefilter prefilter = run.stage("pyramid", [&] { return Prefilter(latlong); });
  const Lobe lobe = options.lobe == "ggx" ? Lobe::kGgx : Lobe::kPhong;
  run.answer["levels"] = Json::array();
  for (int level = 0; level < options.levels; ++level) {
    const std::string name = fmt::format("level_{}", level);
    const double roughness = options.roughness(level);
    const int width = options.level_width(level);
    run.stage(name, [&] {
      if (options.cube) {
        writer.write_faces(name, prefilter.cube(width, roughness, lobe, options.samples));
      } else {
        writer.write_latlong(name, prefilter.latlong({width, width / 2}, roughness, lobe, options.samples));
      }
    });
    run.answer["levels"].push_back({{"path", writer.path_of(name)}, {"roughness", roughness}, {"width", width}});
    run.say(fmt::format("roughness {:.3f}: {} ({} wide)", roughness, writer.path_of(name), width));
  }
}

}  // namespace

std::function<int(Run&)> declare_prefilter(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->declare(app);
  return [options](Run& run) {
    const Probe probe = options->probe.read(run);
    make_folder(options->output);
    const Image<float> latlong = run.stage("lat-long", [&] { return latlong_from_probe(probe.map, probe.projection); });
    const Writer writer(run, *options, probe);
    write_levels(run, *options, writer, latlong);
    run.stage("irradiance", [&] {
      const Sh sh = project(latlong, LatLong{latlong.size()}, kIrradianceDegree);
      if (options->cube) {
        writer.write_faces("irradiance", cube_map(kIrradianceWidth / 2,
                                                  [&](const Vec3& n) { return Rgb(irradiance(sh, n).max(0.0)); }));
      } else {
        writer.write_latlong("irradiance", irradiance_map(sh, {kIrradianceWidth, kIrradianceWidth / 2}));
      }
    });
    run.answer["irradiance"] = writer.path_of("irradiance");
    run.stage("brdf", [&] {
      RadianceMap table;
      table.rgb = split_sum_table(kTableSize);
      write_map(Path(options->output) / "brdf.exr", table, provenance_of(run, Path{}), writer.kFloat);
    });
    run.answer["brdf"] = (Path(options->output) / "brdf.exr").string();
    run.say("irradiance: " + writer.path_of("irradiance") + ", split-sum table: brdf.exr (x n.v, y roughness)");
    return 0;
  };
}

}  // namespace hdr::tools
