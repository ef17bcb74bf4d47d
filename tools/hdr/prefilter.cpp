#include "libhdr/light/prefilter.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "libhdr/light/cube.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/frequency_prefilter.h"
#include "libhdr/light/sh.h"
#include "libhdr/light/sh_latlong.h"
#include "tools/hdr/cube_output.h"
#include "tools/hdr/folder.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"

namespace hdr::tools {
namespace {

constexpr int kIrradianceWidth = 64, kIrradianceDegree = 12, kTableSize = 128;

struct Options {
  ProbeInput probe;
  std::string output, lobe = "ggx", method = "sampling";
  int levels = 6, width = 256, samples = 512;
  double error = 0.01;
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
  app.add_option("--method", method,
                 "sampling (directions of the lobe), or frequency: as products of harmonics within --error, levels "
                 "that are too sharp for them by sampling")
      ->check(CLI::IsMember({"sampling", "frequency"}))
      ->capture_default_str();
  app.add_option("--error", error, "with --method frequency: of a level, relative to its largest value")
      ->check(CLI::Range(1e-6, 1.0))
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

Image<float> positive(Image<float> map) {
  for (int y = 0; y < map.height(); ++y)
    for (int k = 0; k < 3 * map.width(); ++k) map.row(y)[k] = std::max(0.0f, map.row(y)[k]);
  return map;
}

class Levels {
 public:
  Levels(Run& run, const Options& options, const Writer& writer, View<const float> latlong)
      : run_(run), options_(options), writer_(writer), latlong_(latlong) {
    if (options.method == "frequency")
      bands_ = run.stage("harmonics", [&] { return std::make_optional<FrequencyPrefilter>(latlong); });
  }

  void write_all() {
    run_.answer["levels"] = Json::array();
    for (int level = 0; level < options_.levels; ++level) {
      Json row = {{"path", writer_.path_of(name(level))},
                  {"roughness", options_.roughness(level)},
                  {"width", options_.level_width(level)}};
      row.update(write(level));
      run_.say(fmt::format("roughness {:.3f}: {} ({} wide){}", options_.roughness(level),
                           row["path"].get<std::string>(), options_.level_width(level), doubt_of(row)));
      run_.answer["levels"].push_back(std::move(row));
    }
  }

 private:
  static std::string name(int level) { return fmt::format("level_{}", level); }

  static std::string doubt_of(const Json& row) {
    if (!row.contains("error_bound")) return "";
    const double bound = row["error_bound"];
    if (row["method"] == "sampling")
      return fmt::format(", sampled: degree {} would be within {:.2g} only", kMaxShDegree, bound);
    return fmt::format(", degree {}, within {:.2g} of its largest value (bound)", row["degree"].get<int>(), bound);
  }

  // What there is to say of how it was made.
  Json write(int level) {
    const double roughness = options_.roughness(level);
    if (!bands_ || roughness == 0) {
      sample(level);
      return {{"method", "sampling"}};
    }
    const FrequencyPrefilter::Level result = run_.stage(name(level), [&] {
      FrequencyPrefilter::Level found = bands_->level(roughness, lobe(), options_.error);
      if (found.met) tabulate(level, found.sh);
      return found;
    });
    if (!result.met) {
      sample(level);
      return {{"method", "sampling"}, {"error_bound", result.bound}};
    }
    if (result.sh.degree < kMaxShDegree) {
      run_.clock.skipped(fmt::format("bands above {}: together they are within {:.2g} of the level's largest value",
                                     result.sh.degree, result.bound));
    }
    return {{"method", "frequency"}, {"degree", result.sh.degree}, {"error_bound", result.bound}};
  }

  void tabulate(int level, const Sh& sh) {
    const int width = options_.level_width(level);
    if (options_.cube) {
      writer_.write_faces(name(level), cube_map(width, [&](const Vec3& d) { return Rgb(evaluate(sh, d).max(0.0)); }));
    } else {
      writer_.write_latlong(name(level), positive(latlong_of(sh, {width, width / 2})));
    }
  }

  void sample(int level) {
    if (!pyramid_) pyramid_ = run_.stage("pyramid", [&] { return std::make_optional<Prefilter>(latlong_); });
    const int width = options_.level_width(level);
    const double roughness = options_.roughness(level);
    run_.stage(name(level), [&] {
      if (options_.cube) {
        writer_.write_faces(name(level), pyramid_->cube(width, roughness, lobe(), options_.samples));
      } else {
        writer_.write_latlong(name(level), pyramid_->latlong({width, width / 2}, roughness, lobe(), options_.samples));
      }
    });
  }

  Lobe lobe() const { return options_.lobe == "ggx" ? Lobe::kGgx : Lobe::kPhong; }

  Run& run_;
  const Options& options_;
  const Writer& writer_;
  View<const float> latlong_;
  std::optional<FrequencyPrefilter> bands_;
  std::optional<Prefilter> pyramid_;  ///< made when the first level asks for it
};

}  // namespace

std::function<int(Run&)> declare_prefilter(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->declare(app);
  return [options](Run& run) {
    const Probe probe = options->probe.read(run);
    make_folder(options->output);
    const Image<float> latlong = run.stage("lat-long", [&] { return latlong_from_probe(probe.map, probe.projection); });
    const Writer writer(run, *options, probe);
    Levels(run, *options, writer, latlong).write_all();
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
