// How far response and map are from the truth, on brackets as cameras write them, beside what they must reach.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/io/bracket.h"
#include "libhdr/merge/merge.h"
#include "libhdr/response/calibrate.h"
#include "tests/bench/brackets.h"
#include "tests/bench/film.h"
#include "tests/bench/score.h"
#include "tests/support/support.h"

namespace hdr::bench {
namespace {

/// A kind of bracket, and what its answer must reach.
struct Kind {
  const char* name;
  const char* format;
  double step;
  bool off_grid;  ///< one more shot, two thirds of a stop from the middle
  double rms, median, p99, cap;
};

constexpr Kind kKinds[] = {
    {"sRGB JPEG 2 EV", "jpg", 2, false, .010, .0175, .095, .02},
    {"gamma 2.2 PNG 1 EV", "png", 1, false, .020, .0055, .028, .02},
    {"linear JPEG 2 EV", "jpg", 2, false, .016, .022, .20, .02},
    {"film JPEG 2 EV", "jpg", 2, false, .045, .035, .25, .05},
    {"film JPEG 2 EV, one off", "jpg", 2, true, .020, .020, .15, .05},
};

Response response_of(const Kind& kind, std::uint64_t seed) {
  const std::string name = kind.name;
  if (name.starts_with("sRGB")) return srgb_response(8);
  if (name.starts_with("gamma")) return gamma_response(8, 2.2);
  if (name.starts_with("linear")) return linear_response(8);
  return random_film_response(seed);
}

struct Outcome {
  double rms = 0;
  MapScore score;
  MapScore known;  ///< merged with the true response: what the photographs allow this merge
};

Outcome measure(const Kind& kind, Size size, int shots, std::uint64_t seed) {
  const test::ScratchDir scratch;
  BracketPlan plan;
  plan.size = size;
  plan.evs = uniform_evs(shots, kind.step);
  if (kind.off_grid) plan.evs.push_back(0.67);
  plan.response = response_of(kind, seed);
  plan.format = kind.format;
  plan.seed = seed;
  const Truth truth = photograph(plan, scratch.path());
  const Bracket bracket = read_bracket({scratch.path()});
  const Response fitted = calibrate_debevec_malik(bracket).response;
  const Merged merged = merge(bracket, no_alignment(bracket), fitted);
  const Merged known = merge(bracket, no_alignment(bracket), truth.response);
  return {response_rms(fitted, truth.response), score_map(merged.map.rgb, truth), score_map(known.map.rgb, truth)};
}

/// The number, with a mark when it is over its bound.
std::string cell(double value, double must) {
  return fmt::format("{:7.4f}{}", value, value <= must ? " " : "*");
}

bool print(const Kind& kind, std::uint64_t seed, const Outcome& outcome) {
  const double cap_error = std::isnan(outcome.score.cap) ? 0 : std::abs(outcome.score.cap - 1);
  const bool met = outcome.rms <= kind.rms && outcome.score.median <= kind.median && outcome.score.p99 <= kind.p99 &&
                   cap_error <= kind.cap && outcome.score.bad == 0;
  fmt::print("{:<26} {:>4}  {} {} {}  {:6.3f}{} {:>4}  {:.4f} {:.4f} {:.3f}  {}\n", kind.name, seed,
             cell(outcome.rms, kind.rms), cell(outcome.score.median, kind.median), cell(outcome.score.p99, kind.p99),
             outcome.score.cap, cap_error <= kind.cap ? " " : "*", outcome.score.bad, outcome.known.median,
             outcome.known.p99, outcome.known.cap, met ? "met" : "missed");
  std::fflush(stdout);
  return met;
}

int main(int argc, char** argv) {
  std::string size_text = "1500x1000", only;
  int seeds = 3, shots = 9;
  bool strict = false;
  CLI::App app("  accuracy_bench --size 1500x1000 --seeds 3\n\nresponse and map against the truth");
  app.add_option("--size", size_text, "of a shot, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--shots", shots, "of a bracket")->check(CLI::Range(3, 40))->capture_default_str();
  app.add_option("--seeds", seeds, "scenes, and film curves, of each kind")->capture_default_str();
  app.add_option("--only", only, "kinds whose name holds this");
  app.add_flag("--strict", strict, "exit 1 when a bound is missed, not only when an answer is wrong");
  CLI11_PARSE(app, argc, argv);
  Size size;
  if (std::sscanf(size_text.c_str(), "%dx%d", &size.width, &size.height) != 2 || size.width < 64 || size.height < 64) {
    throw Error("--size: give WIDTHxHEIGHT, 64 pixels or more");
  }
  fmt::print(
      "{} shots of {}; * over the bound\n{:<26} seed  rms ln   median   p99       cap    bad  with the true response\n",
      shots, size_text, "bracket");
  bool all_met = true, all_right = true;
  for (const Kind& kind : kKinds) {
    if (std::string(kind.name).find(only) == std::string::npos) continue;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Outcome outcome = measure(kind, size, shots, static_cast<std::uint64_t>(seed));
      all_met = print(kind, static_cast<std::uint64_t>(seed), outcome) && all_met;
      all_right = all_right && outcome.score.bad == 0 && outcome.score.median < 0.1;
    }
    fmt::print("{:<26} must {:7.4f}  {:7.4f}  {:7.4f}  1+-{:.2f}     0\n", "", kind.rms, kind.median, kind.p99,
               kind.cap);
  }
  if (!all_right) fmt::print(stderr, "accuracy_bench: an answer is wrong\n");
  return all_right && (all_met || !strict) ? 0 : 1;
}

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) try { return hdr::bench::main(argc, argv); } catch (const std::exception& e) {
  fmt::print(stderr, "accuracy_bench: {}\n", e.what());
  return 1;
}
