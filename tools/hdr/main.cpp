// hdr: one binary, a table of verbs. Exit 0 done, 1 could not (one line says why), 2 misused.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <set>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/photo.h"
#include "libhdr/core/version.h"
#include "tools/hdr/command.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {
namespace {

constexpr Verb kVerbs[] = {
    {"probe", "the main job", "photographs of a mirror ball -> a light probe", "hdr probe shots/ -o probe.exr",
     declare_probe},
    {"shoot", "photographs", "takes a bracket with a camera", "hdr shoot --camera virtual:scene.exr --auto -o shots",
     declare_shoot},
    {"cameras", "photographs", "lists the cameras, their formats and exposure ranges", "hdr cameras --json",
     declare_cameras},
    {"simulate", "photographs", "photographs a radiance map with a camera model, truth included",
     "hdr simulate scene.exr --ball --times 1/1000,1/250,1/60,1/15 -o shots", declare_simulate},
    {"info", "photographs", "what is in a file: every pixel is read", "hdr info shots/*.jpg", declare_info},
    {"calibrate", "radiance maps", "the camera's response from a bracket", "hdr calibrate shots/ -o response.json",
     declare_calibrate},
    {"align", "radiance maps", "registers the shots of a bracket", "hdr align shots/ --json", declare_align},
    {"merge", "radiance maps", "a bracket -> a radiance map", "hdr merge shots/ -o map.exr", declare_merge},
    {"unwrap", "light probes", "from one picture of the sphere to another",
     "hdr unwrap ball.exr -o probe.exr --from mirror-ball --to latlong --width 2048", declare_unwrap},
    {"stitch", "light probes", "photographs of one place -> the sphere around it",
     "hdr stitch photos/*.jpg -o probe.exr --width 4096", declare_stitch},
    {"sh", "light", "spherical harmonics and irradiance of a probe", "hdr sh probe.exr -o sh.json", declare_sh},
    {"lights", "light", "a probe as N directional lights", "hdr lights probe.exr -n 64 -o lights.usda", declare_lights},
    {"unclip", "light", "gives clipped suns the light that a meter measured",
     "hdr unclip probe.exr -o sun.exr --target-lux 65000", declare_unclip},
    {"prefilter", "light", "a probe for real-time engines: GGX levels, irradiance, split-sum table",
     "hdr prefilter probe.exr -o probe-levels", declare_prefilter},
    {"prt", "light", "a mesh's transfer of light: lit by any probe at once", "hdr prt bunny.obj -o bunny.prt",
     declare_prt},
    {"render", "light", "a test render lit by a probe", "hdr render --probe probe.exr -o render.exr", declare_render},
    {"composite", "light", "objects into a photograph, with their shadows and its light",
     "hdr composite --background photo.jpg --probe probe.exr --objects chair.glb --eye 0,1.6,4 --look 0,0.5,0 --fov 60 "
     "-o composite.png",
     declare_composite},
    {"tonemap", "pictures", "a map -> a PNG or JPEG to look at", "hdr tonemap probe.exr -o probe.png", declare_tonemap},
    {"fuse", "pictures", "a bracket -> one picture to look at, without a radiance map", "hdr fuse shots/ -o fused.png",
     declare_fuse},
    {"filter", "pictures", "blurs in linear light, exposure in stops", "hdr filter probe.exr -o soft.exr --gaussian 20",
     declare_filter},
    {"convert", "pictures", "the same light in another format", "hdr convert map.hdr map.exr", declare_convert},
    {"diff", "pictures", "how far apart two maps are", "hdr diff probe.exr truth.exr --scale channel", declare_diff},
    {"bench", "this machine", "time against error of every stage, with the rivals that are installed",
     "hdr bench sh lights --quick", declare_bench},
};

void print_map() {
  fmt::print("hdr {}: from bracketed photographs to light\n", kVersion);
  const char* group = "";
  for (const Verb& verb : kVerbs) {
    if (std::string_view(group) != verb.group) fmt::print("\n  {}\n", group = verb.group);
    fmt::print("    {:<10} {}\n", verb.name, verb.sentence);
  }
  fmt::print(
      "\nThe main job:      hdr probe shots/ -o probe.exr && hdr render --probe probe.exr -o render.exr\n"
      "More about a verb: hdr VERB --help\n");
}

const Verb* find_verb(std::string_view name) {
  for (const Verb& verb : kVerbs) {
    if (name == verb.name) return &verb;
  }
  return nullptr;
}

void finish_answer(Run& run) {
  Json stages = Json::array();
  for (const Stage& stage : run.clock.stages()) {
    Json row = {{"name", stage.name}, {"seconds", stage.seconds}, {"cpu_seconds", stage.cpu_seconds}};
    if (!stage.skipped.empty()) row["skipped"] = stage.skipped;
    stages.push_back(std::move(row));
    std::string line = fmt::format("  {:<10} {:7.2f} s", stage.name, stage.seconds);
    if (!stage.skipped.empty()) line += "   skipped: " + stage.skipped;
    run.say(line);
  }
  run.answer["stages"] = std::move(stages);
  // JSON has no NaN or infinity: nlohmann writes null, and bytes that are no UTF-8 (file names) are replaced.
  if (run.json) fmt::print("{}\n", run.answer.dump(2, ' ', false, Json::error_handler_t::replace));
}

/// Provenance: everything on the command line that changes pixels, in the order given.
std::string pixel_options(const CLI::App& app) {
  static constexpr std::string_view kNotPixels[] = {"--threads", "--json",     "--quiet",         "--version",
                                                    "--help",    "--save-map", "--save-response", "--irradiance-map",
                                                    "-o",        "shots",      "--cut-out",       "--report"};
  static constexpr std::string_view kPaths[] = {"--exposures",  "--response",   "--probe",   "--scene", "--flat",
                                                "--scale-like", "--background", "--objects", "--ground"};
  std::set<std::string> seen;
  std::string text;
  for (const CLI::Option* option : app.parse_order()) {
    const std::string name = option->get_name();
    bool skip = false;
    for (const std::string_view other : kNotPixels) skip |= name == other || option->check_name(std::string(other));
    if (skip || option->get_positional()) continue;
    if (!seen.insert(name).second) continue;  // parse_order lists an option once for each value
    text += (text.empty() ? "" : " ") + name;
    if (option->get_expected_max() == 0) continue;  // a flag
    const bool is_path = std::find(std::begin(kPaths), std::end(kPaths), name) != std::end(kPaths);
    for (const std::string& value : option->results()) {
      text += " " + (is_path ? Path(value).filename().string() : value);  // names without folders
    }
  }
  return text;
}

int run_verb(const Verb& verb, int argc, char** argv) {
  CLI::App app(fmt::format("  {}\n\n{}", verb.example, verb.sentence), std::string("hdr ") + verb.name);
  app.get_formatter()->column_width(34);
  Run run;
  const auto work = verb.declare(app);
  app.add_option("--threads", run.threads, "threads to use (default: all); results do not depend on it")
      ->check(CLI::Range(1, 1024));
  app.add_flag("--json", run.json, "one JSON object on stdout");
  app.add_flag("--quiet", run.quiet, "no progress, no warnings, no summary");
  app.set_version_flag("--version", std::string("hdr ") + kVersion);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  if (run.threads > 0) set_threads(run.threads);
  run.options = pixel_options(app);
  try {
    const int code = work(run);
    finish_answer(run);
    return code;
  } catch (const CLI::ParseError& e) {  // options that contradict each other
    fmt::print(stderr, "hdr {}: {}\n", verb.name, e.what());
    return 2;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "hdr {}: not enough memory for a picture of this size\n", verb.name);
  } catch (const std::exception& e) {
    fmt::print(stderr, "hdr {}: {}\n", verb.name, e.what());
  }
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view name = argc > 1 ? argv[1] : "";
  if (name.empty() || name == "--help" || name == "-h" || name == "help") {
    print_map();
    return 0;
  }
  if (name == "--version") {
    fmt::print("hdr {}\n", kVersion);
    return 0;
  }
  const Verb* verb = find_verb(name);
  if (!verb) {
    fmt::print(stderr, "hdr: no verb '{}'; `hdr` alone lists them\n", name);
    return 2;
  }
  return run_verb(*verb, argc - 1, argv + 1);
}

}  // namespace hdr::tools
