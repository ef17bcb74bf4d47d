// Calibrating and merging against a rival, and the whole command against decoding and writing alone, in one run.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/bracket.h"
#include "libhdr/io/read.h"
#include "libhdr/merge/merge.h"
#include "libhdr/response/calibrate.h"
#include "tests/bench/brackets.h"
#include "tests/bench/decode_and_write.h"
#include "tests/bench/rivals/rival.h"
#include "tests/bench/score.h"
#include "tests/bench/stopwatch.h"
#include "tests/support/support.h"

namespace hdr::bench {
namespace {

constexpr double kSaneMedian = 0.1;  // |log2|: a map farther off than this is no answer, and its time means nothing

struct Options {
  std::string size = "6000x4000", folder;
  int shots = 9, repeats = 3, threads = 0;
  double step = 2;
};

struct Row {
  std::string name;
  Runs runs;
  MapScore score;
  double response_rms = 0;
  bool sane = false;
};

bool is_sane(const MapScore& score) {
  return score.bad == 0 && score.median < kSaneMedian;
}

Merged calibrate_and_merge(const Bracket& bracket) {
  return merge(bracket, no_alignment(bracket), calibrate_debevec_malik(bracket).response);
}

void print(const Row& row) {
  const Seconds least = row.runs.least(), median = row.runs.median();
  const std::string time = row.runs.count() == 0 ? "not timed: its answer is not sane"
                                                 : fmt::format("cpu {:7.2f} ({:7.2f})  wall {:7.2f} ({:7.2f})",
                                                               least.cpu, median.cpu, least.wall, median.wall);
  fmt::print("  {:<26} {}", row.name, time);
  if (row.score.median > 0) {
    fmt::print("  rms {} median {:.4f} p99 {:.4f} cap {:.3f} bad {}",
               row.response_rms > 0 ? fmt::format("{:.4f}", row.response_rms) : "  -   ", row.score.median,
               row.score.p99, row.score.cap, row.score.bad);
  }
  fmt::print("\n");
}

/// The bounds speak of 9 shots of 24 MP: a small bracket is all start-up.
struct Bound {
  double must, goal;
  bool higher_is_better, applies;
};

void print_verdict(const std::string& what, double ratio, const Bound& b) {
  if (!b.applies) return fmt::print("{}: {:.2f} x\n", what, ratio);
  const auto met = [&](double bound) { return b.higher_is_better ? ratio >= bound : ratio <= bound; };
  fmt::print("{}: {:.2f} x; must {} {:g}: {}; goal {:g}: {}\n", what, ratio, b.higher_is_better ? ">=" : "<=", b.must,
             met(b.must) ? "met" : "MISSED", b.goal, met(b.goal) ? "met" : "missed");
}

bool bounds_apply(const Truth& truth) {
  const Size size = truth.radiance.size();
  return 1e-6 * size.width * size.height * static_cast<double>(truth.seconds.size()) > 200;
}

/// The libraries on decoded shots. Returns false when our answer is wrong.
bool bench_library(const Options& options, const std::vector<Path>& files, const Truth& truth, int step) {
  const Bracket bracket = read_bracket(files);
  Row ours{"calibrate + merge", {}, {}, 0, false};
  {
    const Calibration calibration = calibrate_debevec_malik(bracket);
    ours.response_rms = response_rms(calibration.response, truth.response);
    ours.score = score_map(merge(bracket, no_alignment(bracket), calibration.response).map.rgb, truth, step);
    ours.sane = is_sane(ours.score);
  }
  const auto rivals = available_rivals();
  std::vector<Row> theirs;
  for (const auto& rival : rivals) {
    const RivalAnswer answer = rival->run(bracket, threads());
    Row row{
        rival->name(), {}, score_map(answer.map, truth, step), response_rms(answer.response, truth.response), false};
    // Where every shot clips OpenCV writes what it does; it is asked about what it can see.
    row.sane = row.score.median < kSaneMedian;
    theirs.push_back(std::move(row));
  }
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    if (ours.sane) ours.runs.time([&] { return calibrate_and_merge(bracket); });
    for (std::size_t k = 0; k < rivals.size(); ++k) {
      if (theirs[k].sane) theirs[k].runs.time([&] { return rivals[k]->run(bracket, threads()); });
    }
  }
  print(ours);
  for (const Row& row : theirs) print(row);
  if (rivals.empty()) fmt::print("  no rival: install libopencv-photo-dev and build again\n");
  for (const Row& row : theirs) {
    if (!row.sane || !ours.sane) continue;
    print_verdict("CPU of " + row.name + " over ours", row.runs.least().cpu / ours.runs.least().cpu,
                  Bound{8, 15, true, bounds_apply(truth)});
  }
  return ours.sane;
}

/// The command from JPEG to EXR. Returns false when its map is wrong.
bool bench_command(const Options& options, const std::vector<Path>& files, const Truth& truth, int step,
                   const Path& folder) {
  const Path output = folder / "map.exr";
  std::vector<std::string> line = {"merge"};
  for (const Path& file : files) line.push_back(file.string());
  line.insert(line.end(), {"-o", output.string(), "--quiet", "--threads", std::to_string(threads())});
  const auto run = [&] {
    const test::CommandResult result = test::run_hdr(line);
    if (result.exit_code != 0) throw Error("hdr merge failed: " + result.err);
  };
  run();
  const RadianceMap map = read_map(output, {NonFinite::kKeep}).map;
  Row command{"hdr merge, JPEG to EXR", {}, score_map(map.rgb, truth, step), 0, false};
  command.sane = is_sane(command.score);
  Row floor{"decode all + write", {}, {}, 0, true};
  for (int repeat = 0; repeat < options.repeats && command.sane; ++repeat) {
    command.runs.time(run);
    floor.runs.time([&] { decode_and_write(files, map.rgb, folder / "floor.exr"); });
  }
  print(command);
  print(floor);
  if (command.sane) {
    print_verdict("CPU of hdr merge over decode + write", command.runs.least().cpu / floor.runs.least().cpu,
                  Bound{1.8, 1.4, false, bounds_apply(truth)});
    print_verdict("wall of hdr merge over decode + write", command.runs.least().wall / floor.runs.least().wall,
                  Bound{1.8, 1.4, false, bounds_apply(truth)});
  }
  return command.sane;
}

int main(int argc, char** argv) {
  Options options;
  CLI::App app("  merge_bench --size 6000x4000 --shots 9\n\ntime against error of calibrating and merging");
  app.add_option("--size", options.size, "of a shot, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--shots", options.shots, "of the bracket")->check(CLI::Range(2, 40))->capture_default_str();
  app.add_option("--step", options.step, "stops between shots")->capture_default_str();
  app.add_option("--repeats", options.repeats, "of each piece of work, interleaved")->capture_default_str();
  app.add_option("--threads", options.threads, "threads (default: all)");
  app.add_option("--folder", options.folder, "where shots and maps go (default: a scratch folder, removed)");
  CLI11_PARSE(app, argc, argv);
  if (options.threads > 0) set_threads(options.threads);
  Size size;
  if (std::sscanf(options.size.c_str(), "%dx%d", &size.width, &size.height) != 2 || size.width < 64 ||
      size.height < 64) {
    throw Error("--size: give WIDTHxHEIGHT, 64 pixels or more");
  }

  const test::ScratchDir scratch;
  const Path folder = options.folder.empty() ? scratch.path() : Path(options.folder);
  BracketPlan plan;
  plan.size = size;
  plan.evs = uniform_evs(options.shots, options.step);
  plan.response = srgb_response(8);
  const Truth truth = photograph(plan, folder / "shots");
  const std::vector<Path> files = expand_shots({folder / "shots"});
  const double megapixels = 1e-6 * size.width * size.height;
  fmt::print("{} shots of {:.1f} MP, {:g} EV apart, sRGB JPEG q95, {} threads; seconds: least (median) of {}\n",
             options.shots, megapixels, options.step, threads(), options.repeats);
  const int step = megapixels > 4 ? 2 : 1;
  const bool library_right = bench_library(options, files, truth, step);
  const bool command_right = bench_command(options, files, truth, step, folder);
  if (library_right && command_right) return 0;
  fmt::print(stderr, "merge_bench: an answer is wrong\n");
  return 1;
}

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) try { return hdr::bench::main(argc, argv); } catch (const std::exception& e) {
  fmt::print(stderr, "merge_bench: {}\n", e.what());
  return 1;
}
