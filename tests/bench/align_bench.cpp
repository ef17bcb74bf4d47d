// Registration against motion that is known, beside a rival: how far off each shot is, then how long it took.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libhdr/align/align.h"
#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/bracket.h"
#include "libhdr/merge/merge.h"
#include "libhdr/response/calibrate.h"
#include "tests/bench/brackets.h"
#include "tests/bench/film.h"
#include "tests/bench/hand_shake.h"
#include "tests/bench/rivals/rival.h"
#include "tests/bench/stopwatch.h"
#include "tests/support/support.h"

namespace hdr::bench {
namespace {

constexpr double kSane = 0.5;  // px: an answer whose median shot is farther off is none, and its time means nothing

struct Options {
  std::string size = "4000x3000", maps, format = "jpg";
  int shots = 9, seeds = 3, first_seed = 1, repeats = 2, threads = 0;
  double step = 2, shift = 12, turn = 0.2;
};

/// Medians over the picture of the shots that show enough, the reference left out.
struct Score {
  std::vector<double> medians;
  double worst_corner = 0;
  double median() const {
    std::vector<double> sorted = medians;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? 0 : sorted[sorted.size() / 2];
  }
  double worst() const { return medians.empty() ? 0 : *std::max_element(medians.begin(), medians.end()); }
  void add(const Score& more) {
    medians.insert(medians.end(), more.medians.begin(), more.medians.end());
    worst_corner = std::max(worst_corner, more.worst_corner);
  }
};

Score score(const std::vector<Mat3>& scene_from_photo, const std::vector<Mat3>& found, std::size_t reference,
            const std::vector<double>& shares, Size size) {
  constexpr double kFewestUsable = 0.02;
  Score score;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (k == reference || shares[k] < kFewestUsable) continue;
    const Mat3 truth = scene_from_photo[reference].inverse() * scene_from_photo[k];
    const std::vector<double> all = motion_distances(truth, found[k], size);
    score.medians.push_back(all[all.size() / 2]);
    score.worst_corner = std::max(score.worst_corner, all.back());
  }
  return score;
}

void print_rows(const Bracket& bracket, const Alignment& ours, const std::vector<Mat3>& truth,
                const std::vector<double>& shares) {
  const auto reference = static_cast<std::size_t>(ours.reference);
  for (std::size_t k = 0; k < bracket.shots.size(); ++k) {
    const Mat3 ref_from_photo = truth[reference].inverse() * truth[k];
    const std::vector<double> all = motion_distances(ref_from_photo, ours.frames[k].ref_from_photo, bracket.size());
    const double seen = rms_distance_where_usable(ref_from_photo, ours.frames[k].ref_from_photo, bracket.shots[k]);
    fmt::print(
        "    {} usable {:.3f} off {:7.3f} (farthest {:7.3f}, where it is usable {:7.3f}) residual {:7.3f} inliers "
        "{:.2f} {}\n",
        bracket.shots[k].path.filename().string(), shares[k], all[all.size() / 2], all.back(), seen,
        ours.frames[k].residual_px, ours.frames[k].inliers, ours.frames[k].skipped);
  }
}

struct Contender {
  std::string name;
  Score score;
  Runs runs;
};

void bench_bracket(const Options& o, Size size, std::uint64_t seed, const Path& map, Contender& ours,
                   std::vector<Contender>& theirs) {
  const test::ScratchDir scratch;
  const char* const responses[] = {"srgb", "film", "gamma:2.2", "random film"};
  const std::string response = responses[seed % 4];
  BracketPlan plan;
  plan.size = size;
  plan.evs = uniform_evs(o.shots, o.step);
  plan.response = response == "random film" ? random_film_response(seed) : *response_from_name(response, 8);
  plan.format = o.format;
  plan.seed = seed;
  plan.map = map;
  plan.scene_from_photo = hand_shake(size, o.shots, o.shift, o.turn, seed);
  photograph(plan, scratch.path());
  const Bracket bracket = read_bracket({scratch.path()});
  std::vector<double> shares;
  for (const Photo& photo : bracket.shots) shares.push_back(usable_share(photo));
  const auto align_ours = [&] { return align(bracket, provisional_response(bracket)); };
  const Alignment found = align_ours();
  const Score score_ours =
      score(plan.scene_from_photo, found.ref_from_photo(), static_cast<std::size_t>(found.reference), shares, size);
  fmt::print("  seed {} {} {}: median shot {:.3f}, worst {:.3f}, farthest corner {:.3f} px\n", seed, response,
             map.empty() ? "invented scene" : map.filename().string(), score_ours.median(), score_ours.worst(),
             score_ours.worst_corner);
  print_rows(bracket, found, plan.scene_from_photo, shares);
  ours.score.add(score_ours);
  for (int k = 0; k < o.repeats && score_ours.median() < kSane; ++k) ours.runs.time(align_ours);
  const auto rivals = available_align_rivals();
  for (std::size_t r = 0; r < rivals.size(); ++r) {
    const auto run = [&] { return rivals[r]->run(bracket, threads()); };
    theirs[r].score.add(score(plan.scene_from_photo, run(), (bracket.shots.size() - 1) / 2, shares, size));
    for (int k = 0; k < o.repeats; ++k) theirs[r].runs.time(run);
  }
  std::fflush(stdout);
}

void print(const Contender& c) {
  fmt::print("{:<18} median shot {:.3f}, worst {:.3f}, farthest corner {:.3f} px; {}\n", c.name, c.score.median(),
             c.score.worst(), c.score.worst_corner,
             c.runs.count() == 0 ? "not timed: its answer is not sane"
                                 : fmt::format("cpu {:.2f} ({:.2f}) s, wall {:.2f} s, least (median)",
                                               c.runs.least().cpu, c.runs.median().cpu, c.runs.least().wall));
}

std::vector<Path> maps_in(const std::string& folder) {
  std::vector<Path> maps;
  if (folder.empty()) return maps;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".hdr" || extension == ".exr") maps.push_back(entry.path());
  }
  std::sort(maps.begin(), maps.end());
  return maps;
}

/// What registering costs beside merging, and where it leaves the shots.
void measure_photographs(const Path& folder, int repeats) {
  BracketOptions options;
  const Path list = folder / "image_list.txt";
  if (std::filesystem::exists(list)) options.exposures = list;
  const Bracket bracket = read_bracket({folder}, options);
  const Response response = provisional_response(bracket);
  Alignment found;
  Runs aligning, merging;
  for (int k = 0; k < repeats; ++k) {
    aligning.time([&] { found = align(bracket, response); });
    merging.time([&] { merge(bracket, found, response); });
  }
  const double align_cpu = aligning.least().cpu, merge_cpu = merging.least().cpu;
  fmt::print("{}: {} shots of {:.1f} MP, align {:.3f} s, merge {:.3f} s CPU: {:.1f} % of both; {}\n",
             folder.filename().string(), bracket.shots.size(), 1e-6 * bracket.size().width * bracket.size().height,
             align_cpu, merge_cpu, 100 * align_cpu / (align_cpu + merge_cpu),
             found.identity() ? "nothing is resampled" : "resampled");
  for (std::size_t k = 0; k < found.frames.size(); ++k) {
    fmt::print("    {} residual {:.3f} inliers {:.2f} {}\n", bracket.shots[k].path.filename().string(),
               found.frames[k].residual_px, found.frames[k].inliers, found.frames[k].skipped);
  }
}

int main(int argc, char** argv) {
  Options o;
  std::vector<std::string> photographs;
  CLI::App app("  align_bench --size 4000x3000 --seeds 3\n\nregistration of shaken brackets against the truth");
  app.add_option("--size", o.size, "of a shot, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--shots", o.shots, "of a bracket")->check(CLI::Range(2, 40))->capture_default_str();
  app.add_option("--step", o.step, "stops between shots")->capture_default_str();
  app.add_option("--shift", o.shift, "pixels, at most, each way")->capture_default_str();
  app.add_option("--turn", o.turn, "degrees, at most")->capture_default_str();
  app.add_option("--seeds", o.seeds, "brackets, each with a scene, a camera and a hand of its own")
      ->capture_default_str();
  app.add_option("--first-seed", o.first_seed, "of them")->capture_default_str();
  app.add_option("--maps", o.maps, "folder of radiance maps to photograph (default: invented scenes)");
  app.add_option("--format", o.format, "jpg or png")->capture_default_str();
  app.add_option("--repeats", o.repeats, "of what is timed")->capture_default_str();
  app.add_option("--threads", o.threads, "threads (default: all)");
  app.add_option("--photographs", photographs, "folders of brackets: what registering costs of each, and no more");
  CLI11_PARSE(app, argc, argv);
  if (o.threads > 0) set_threads(o.threads);
  for (const std::string& folder : photographs) measure_photographs(folder, o.repeats);
  if (!photographs.empty()) return 0;
  Size size;
  if (std::sscanf(o.size.c_str(), "%dx%d", &size.width, &size.height) != 2 || size.width < 64 || size.height < 64) {
    throw Error("--size: give WIDTHxHEIGHT, 64 pixels or more");
  }
  fmt::print("{} shots of {:.1f} MP, {:g} EV apart, up to {:g} px and {:g} degrees, {}; distances in pixels\n", o.shots,
             1e-6 * size.width * size.height, o.step, o.shift, o.turn, o.format);
  const std::vector<Path> maps = maps_in(o.maps);
  Contender ours{"hdr align", {}, {}};
  std::vector<Contender> theirs;
  for (const auto& rival : available_align_rivals()) theirs.push_back({rival->name(), {}, {}});
  for (int k = 0; k < o.seeds; ++k) {
    const auto seed = static_cast<std::uint64_t>(o.first_seed + k);
    bench_bracket(o, size, seed, maps.empty() ? Path{} : maps[seed % maps.size()], ours, theirs);
  }
  print(ours);
  for (const Contender& c : theirs) print(c);
  if (theirs.empty()) fmt::print("no rival: install libopencv-photo-dev and build again\n");
  if (ours.score.median() < kSane) return 0;
  fmt::print(stderr, "align_bench: the answer is wrong\n");
  return 1;
}

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) try { return hdr::bench::main(argc, argv); } catch (const std::exception& e) {
  fmt::print(stderr, "align_bench: {}\n", e.what());
  return 1;
}
