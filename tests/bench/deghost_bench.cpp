// Ghosts: how much worse the map of a bracket with something moving is than that of the same bracket without it, and
// what --deghost costs and changes where nothing moves.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>
#include <filesystem>

#include "libhdr/align/align.h"
#include "libhdr/core/error.h"
#include "libhdr/io/bracket.h"
#include "libhdr/io/write.h"
#include "libhdr/merge/merge.h"
#include "tests/bench/ghost_oracle.h"
#include "tests/bench/stopwatch.h"
#include "tests/support/ghost_share.h"
#include "tests/support/movers.h"
#include "tests/support/support.h"

namespace hdr::bench {
namespace {

struct Kind {
  const char* name;
  const char* format;
  Size size;
  int shots;
  double step_ev, object, object_stops, step, shift;
};

// Sizes, textures (the seed), depths of overlap, brightness, formats, hand shake.
constexpr Kind kKinds[] = {
    {"png still camera", "png", {600, 400}, 5, 2, .15, 1.5, .10, 0},
    {"png dark thing", "png", {600, 400}, 5, 2, .15, -2, .10, 0},
    {"png small thing", "png", {900, 600}, 5, 2, .04, 1, .06, 0},
    {"png large, overlapping", "png", {600, 400}, 5, 2, .35, 1, .05, 0},
    {"png 3 shots", "png", {600, 400}, 3, 2, .15, 1.5, .12, 0},
    {"png hand-held", "png", {600, 400}, 5, 2, .15, 1.5, .10, 6},
    {"jpg still camera", "jpg", {600, 400}, 5, 2, .15, 1.5, .10, 0},
    {"jpg faint thing", "jpg", {600, 400}, 5, 2, .15, .5, .10, 0},
    {"jpg hand-held", "jpg", {900, 600}, 5, 2, .12, -1.5, .09, 6},
    {"jpg 7 shots 1 EV", "jpg", {450, 300}, 7, 1, .15, 1.5, .08, 3},
};

test::MoverPlan plan_of(const Kind& kind, std::uint64_t seed) {
  test::MoverPlan plan;
  plan.size = kind.size;
  plan.evs.clear();
  for (int k = 0; k < kind.shots; ++k) plan.evs.push_back(kind.step_ev * (k - (kind.shots - 1) / 2));
  plan.object = kind.object;
  plan.object_stops = kind.object_stops;
  plan.step = kind.step;
  plan.shift = kind.shift;
  plan.seed = seed;
  return plan;
}

/// The shots as files of the kind, read back.
Bracket through_files(const Bracket& shots, const std::string& format, const Path& folder) {
  std::filesystem::create_directories(folder);
  for (std::size_t k = 0; k < shots.shots.size(); ++k) {
    write_photo(folder / fmt::format("shot_{:02d}.{}", k, format), shots.shots[k]);
  }
  BracketOptions options;
  options.expects_motion = true;
  return read_bracket({folder}, options);
}

struct Map {
  Merged merged;
  Seconds seconds;
};

Map merged(const Bracket& bracket, const Alignment& alignment, const Response& response, bool deghost) {
  MergeOptions options;
  options.deghost = deghost;
  const Stopwatch watch;
  Map map{merge(bracket, alignment, response, options), {}};
  map.seconds = watch.elapsed();
  return map;
}

/// The truths are known on the grid of the middle shot.
Alignment on_middle_shot(Alignment alignment, std::size_t middle) {
  const Mat3 middle_from_ref = alignment.frames[middle].ref_from_photo.inverse();
  for (FrameAlignment& frame : alignment.frames) frame.ref_from_photo = middle_from_ref * frame.ref_from_photo;
  alignment.reference = static_cast<int>(middle);
  alignment.frames[middle].ref_from_photo = Mat3::Identity();
  return alignment;
}

/// Things of which the map shows a part: of the pixels that only this shot explains, between 10 and 90 %.
int halves(View<const float> map, const test::MovingScene& scene) {
  int count = 0;
  for (std::size_t k = 0; k < scene.coverage.size(); ++k) {
    double shown = 0, all = 0;
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        bool alone = scene.coverage[k](x, y) == 1;
        for (std::size_t other = 0; other < scene.coverage.size(); ++other) {
          alone = alone && (other == k || scene.coverage[other](x, y) == 0);
        }
        if (!alone) continue;
        const auto distance = [&](const Image<float>& truth) {
          return std::abs(std::log2(map(x, y, 1) / (truth(x, y, 1) * scene.map_per_scene)));
        };
        const double contrast = std::abs(std::log2(scene.truths[k + 1](x, y, 1) / scene.truths[0](x, y, 1)));
        if (contrast < 0.5) continue;
        shown += distance(scene.truths[k + 1]) < distance(scene.truths[0]);
        all += 1;
      }
    }
    count += all > 50 && shown > 0.1 * all && shown < 0.9 * all;
  }
  return count;
}

struct Outcome {
  double ratio = 0, one_moment = 0, any_moment = 0;  ///< to the still bracket's; the latter two are the oracle's
  bool still_unchanged = true;
};

/// The map, its errors (0 where no shot exposes the truth well) and the shots left out, to look at.
void write_pictures(const Path& folder, const std::string& name, const Map& map, const Image<float>& errors) {
  std::filesystem::create_directories(folder);
  RadianceMap picture;
  picture.rgb = map.merged.map.rgb.clone();
  write_map(folder / (name + ".exr"), picture);
  const Image<std::uint8_t>& mask = map.merged.ghosts.mask;
  for (int y = 0; y < errors.height(); ++y) {
    for (int x = 0; x < errors.width(); ++x) {
      float* rgb = picture.rgb.pixel(x, y);
      rgb[0] = std::max(0.0f, errors(x, y));
      rgb[1] = mask.empty() ? 0 : static_cast<float>(mask(x, y)) / 255;
      rgb[2] = 0;
    }
  }
  write_map(folder / (name + "_errors.exr"), picture);
}

Outcome measure(const Kind& kind, std::uint64_t seed, const Path& pictures) {
  const test::MoverPlan plan = plan_of(kind, seed);
  const test::MovingScene scene = moving_scene(plan);
  const test::ScratchDir scratch;
  const Bracket moving = through_files(scene.moving, kind.format, scratch / "moving");
  const Bracket still = through_files(scene.still, kind.format, scratch / "still");
  const std::size_t middle = (plan.evs.size() - 1) / 2;
  const Alignment moving_alignment = on_middle_shot(align(moving, plan.response), middle);
  const Alignment still_alignment = on_middle_shot(align(still, plan.response), middle);
  const Map plain = merged(still, still_alignment, plan.response, false);
  const Map unchanged = merged(still, still_alignment, plan.response, true);
  const Map ghosts = merged(moving, moving_alignment, plan.response, false);
  const Map clean = merged(moving, moving_alignment, plan.response, true);
  const auto p99 = [&](const Map& map) {
    return test::error_quantile(test::closest_errors(map.merged.map.rgb, scene, plan), 0.99);
  };
  if (!pictures.empty()) {
    std::string name = fmt::format("{} {}", kind.name, seed);
    std::replace(name.begin(), name.end(), ' ', '_');
    write_pictures(pictures, name, clean, test::closest_errors(clean.merged.map.rgb, scene, plan));
  }
  Outcome outcome;
  outcome.ratio = p99(clean) / p99(plain);
  MergeOptions options;
  options.exposure_unit = clean.merged.exposure_unit;
  options.noise_estimate = estimate_noise(still, still_alignment.ref_from_photo(), plan.response);
  options.weight = kind.format == std::string("jpg") ? WeightKind::kHat : WeightKind::kVariance;
  const Oracle oracle = oracle_of(moving, moving_alignment, scene, plan, options);
  outcome.one_moment = oracle.one_moment / p99(plain);
  outcome.any_moment = oracle.any_moment / p99(plain);
  for (int y = 0; y < plan.size.height; ++y) {
    const std::size_t bytes = plain.merged.map.rgb.row_samples() * sizeof(float);
    outcome.still_unchanged = outcome.still_unchanged &&
                              std::memcmp(plain.merged.map.rgb.row(y), unchanged.merged.map.rgb.row(y), bytes) == 0;
  }
  std::string references;
  for (const GhostRegion& region : clean.merged.ghosts.regions) references += fmt::format(" {}", region.reference);
  if (references.size() > 20) references = references.substr(0, 20) + " ...";
  fmt::print(
      "{:<24} {:>4}  {:6.4f}  {:6.4f}  {:6.4f}  {:5.2f}{} {:5.2f} {:5.2f}  {:4.1f} % {:>3}  {}  {:5.2f} {:5.2f}  "
      "{:<14} {}\n",
      kind.name, seed, p99(plain), p99(ghosts), p99(clean), outcome.ratio, outcome.ratio < 2 ? ' ' : '*',
      outcome.one_moment, outcome.any_moment, 100 * clean.merged.ghosts.share, clean.merged.ghosts.regions.size(),
      halves(clean.merged.map.rgb, scene), ghosts.seconds.cpu, clean.seconds.cpu,
      outcome.still_unchanged ? "same bytes" : "CHANGED", references);
  std::fflush(stdout);
  return outcome;
}

/// A bracket of photographs for which no truth is known; where little moved, little may change.
void measure_photographs(const Path& folder, const Path& pictures) {
  BracketOptions options;
  options.expects_motion = true;
  const Path list = folder / "image_list.txt";
  if (std::filesystem::exists(list)) options.exposures = list;
  const test::GhostShare share = test::ghost_share(read_bracket({folder}, options));
  fmt::print("{:<24} {:6.3f} % of its pixels change, {:6.3f} % by more than their deviation\n",
             folder.filename().string(), 100 * share.touched, 100 * share.beyond_sigma);
  std::fflush(stdout);
  if (pictures.empty() || share.mask.empty()) return;
  std::filesystem::create_directories(pictures);
  Image<std::uint8_t> picture(share.mask.size(), 3);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) std::fill_n(picture.pixel(x, y), 3, share.mask(x, y));
  }
  write_picture(pictures / (folder.filename().string() + ".png"), picture);
}

struct CameraKind {
  const char* name;
  test::ColourCamera camera;
};

/// Matrices: none, a soft one, two as profiles of cameras have them, a strong one, one that adds; highlights that fade
/// not at all, late, or early; pictures made more vivid than the scene.
std::vector<CameraKind> cameras() {
  using Matrix = std::array<double, 6>;
  const Matrix none{}, soft{-.3, -.1, -.15, -.2, -.05, -.35}, real{-.66, -.12, -.19, -.30, .03, -.43},
      real2{-.45, -.25, -.25, -.2, -.1, -.6}, strong{-1.1, -.1, -.35, -.4, .05, -.75},
      adding{.15, -.2, -.2, .1, .1, -.3};
  return {{"no matrix", {none, 0, 1, 0}},
          {"no matrix, late fade", {none, 0, .8, .5}},
          {"no matrix, early fade", {none, 0, .5, .33}},
          {"soft", {soft, 0, 1, 0}},
          {"real", {real, 0, 1, 0}},
          {"real, vivid", {real, .3, 1, 0}},
          {"real, late fade", {real, 0, .8, .5}},
          {"real, early fade", {real, .15, .5, .33}},
          {"real 2, fade to white", {real2, .15, .7, 1}},
          {"strong", {strong, 0, 1, 0}},
          {"strong, early fade", {strong, .2, .5, .33}},
          {"adding, late fade", {adding, .1, .8, .5}}};
}

/// |log2| p99 of the map against the closest of maps of brackets in which nothing moved.
double p99_of_closest(View<const float> map, const std::vector<Image<float>>& moments) {
  Image<float> errors(map.size(), 1);
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      double least = 1e9;
      for (const Image<float>& moment : moments) {
        least = std::min<double>(least, std::abs(std::log2(map(x, y, 1) / moment(x, y, 1))));
      }
      errors(x, y) = std::isfinite(least) ? static_cast<float>(least) : -1.0f;
    }
  }
  return test::error_quantile(errors, 0.99);
}

/// What --deghost does to a still picture of such a camera, and to one in which a thing moves.
void measure_camera(const CameraKind& kind, const std::string& format, std::uint64_t seed, const Path& pictures) {
  test::MoverPlan plan;
  plan.size = {600, 400};
  plan.camera = kind.camera;
  plan.colour = 1.5;
  plan.object_stops = seed % 2 ? 1.5 : -1.5;
  plan.seed = seed;
  const test::MovingScene scene = test::moving_scene(plan);
  const test::ScratchDir scratch;
  const Bracket still = through_files(scene.still, format, scratch / "still");
  const Bracket moving = through_files(scene.moving, format, scratch / "moving");
  const test::GhostShare share = test::ghost_share(still);
  const Alignment alignment = no_alignment(still);
  const Calibration calibration = calibrate_debevec_malik(moving, {});
  std::vector<Image<float>> moments;
  MergeOptions options;
  options.noise_estimate = calibration.noise;
  for (std::size_t moment = 0; moment < scene.truths.size(); ++moment) {
    test::MoverPlan other = plan;
    other.seed = seed + 100;
    Bracket shots;
    for (std::size_t k = 0; k < plan.evs.size(); ++k) {
      shots.shots.push_back(test::movers::shot_of(scene.truths[moment], other, k));
      shots.input_order.push_back(static_cast<int>(k));
    }
    const Bracket bracket = through_files(shots, format, scratch / fmt::format("moment{}", moment));
    moments.push_back(merge(bracket, alignment, calibration.response, options).map.rgb.clone());
  }
  const Image<float> plain = merge(still, alignment, calibration.response, options).map.rgb.clone();
  const Image<float> ghosts = merge(moving, alignment, calibration.response, options).map.rgb.clone();
  options.deghost = true;
  const Merged clean = merge(moving, alignment, calibration.response, options);
  const double noise = p99_of_closest(plain, moments), left = p99_of_closest(clean.map.rgb, moments);
  fmt::print("{:<24} {} {:>4}  {:7.3f} % {:7.3f} %   {:6.4f}  {:6.4f}  {:6.4f}  {:5.2f}  {:5.1f} %\n", kind.name,
             format, seed, 100 * share.touched, 100 * share.beyond_sigma, noise, p99_of_closest(ghosts, moments), left,
             left / noise, 100 * clean.ghosts.share);
  std::fflush(stdout);
  if (pictures.empty()) return;
  std::filesystem::create_directories(pictures);
  std::string name = fmt::format("{} {}", kind.name, seed);
  std::replace(name.begin(), name.end(), ' ', '_');
  for (std::size_t k = 0; k < still.shots.size(); ++k) {
    write_photo(pictures / fmt::format("{}_{}.png", name, k), scene.still.shots[k]);
  }
  if (!share.mask.empty()) {
    Image<std::uint8_t> picture(share.mask.size(), 3);
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) std::fill_n(picture.pixel(x, y), 3, share.mask(x, y));
    }
    write_picture(pictures / (name + "_mask.png"), picture);
  }
}

int main(int argc, char** argv) {
  int seeds = 3;
  bool colour_cameras = false;
  std::string only, pictures;
  std::vector<std::string> photographs;
  CLI::App app("  deghost_bench --seeds 3\n\na thing that moves against the same bracket without it");
  app.add_option("--seeds", seeds, "scenes of each kind")->capture_default_str();
  app.add_option("--only", only, "kinds whose name holds this");
  app.add_option("--pictures", pictures, "folder for maps, errors (red) and masks (green)");
  app.add_option("--photographs", photographs, "folders of brackets: how much --deghost changes of each, and no more");
  app.add_flag("--cameras", colour_cameras, "cameras with colour matrices: what changes of still pictures");
  CLI11_PARSE(app, argc, argv);
  if (colour_cameras) {
    fmt::print(
        "camera, format, seed; of a still picture: touched, beyond a deviation; of a moving one: p99 of |log2| still, "
        "ghosts, clean, ratio, share\n");
    for (const CameraKind& kind : cameras()) {
      if (std::string(kind.name).find(only) == std::string::npos) continue;
      for (int seed = 1; seed <= seeds; ++seed) {
        for (const char* format : {"png", "jpg"})
          measure_camera(kind, format, static_cast<std::uint64_t>(seed), pictures);
      }
    }
    return 0;
  }
  for (const std::string& folder : photographs) measure_photographs(folder, pictures);
  if (!photographs.empty()) return 0;
  fmt::print(
      "p99 of |log2| against the closest of the truths; * over twice that of the still bracket\n"
      "{:<24} seed  still   ghosts  clean   ratio  oracle: one moment, any; where  regions halves cpu: merge, "
      "--deghost; still with --deghost; "
      "references\n",
      "bracket");
  std::vector<double> ratios, to_oracle;
  bool all_unchanged = true;
  for (const Kind& kind : kKinds) {
    if (std::string(kind.name).find(only) == std::string::npos) continue;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Outcome outcome = measure(kind, static_cast<std::uint64_t>(seed), pictures);
      ratios.push_back(outcome.ratio);
      to_oracle.push_back(outcome.ratio / std::max(1.0, outcome.one_moment));
      all_unchanged = all_unchanged && outcome.still_unchanged;
    }
  }
  if (ratios.empty()) throw Error("--only: no kind has this in its name");
  std::sort(ratios.begin(), ratios.end());
  std::sort(to_oracle.begin(), to_oracle.end());
  const auto under = std::count_if(ratios.begin(), ratios.end(), [](double ratio) { return ratio < 2; });
  fmt::print("ratio: median {:.2f}, worst {:.2f}, under 2 in {} of {}; still brackets {}\n", ratios[ratios.size() / 2],
             ratios.back(), under, ratios.size(), all_unchanged ? "unchanged to the byte" : "CHANGED");
  fmt::print("ratio to an oracle that shows one moment: median {:.2f}, worst {:.2f}\n", to_oracle[to_oracle.size() / 2],
             to_oracle.back());
  return all_unchanged && 4 * under >= 3 * static_cast<std::ptrdiff_t>(ratios.size()) ? 0 : 1;
}

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) try { return hdr::bench::main(argc, argv); } catch (const std::exception& e) {
  fmt::print(stderr, "deghost_bench: {}\n", e.what());
  return 1;
}
