// The response: how many points a fit needs, by method, and what others need for theirs.
#include "libhdr/response/calibrate.h"

#include <fmt/format.h>

#include "libhdr/core/parallel.h"
#include "tests/bench/film.h"
#include "tests/bench/score.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/photographed.h"
#include "tests/bench/suites/suite.h"
#ifdef HDR_RIVAL_OPENCV
#include "tests/bench/rivals/opencv_debevec.h"
#endif

namespace hdr::bench {
namespace {

using Fit = std::function<Response(const Bracket&)>;

BracketPlan plan_of(Size size, std::uint64_t seed) {
  BracketPlan plan;
  plan.size = size;
  plan.evs = {-6, -4, -2, 0, 0.67, 2, 4};  // steps that are all alike leave the curve ambiguous
  plan.response = random_film_response(seed);
  plan.seed = seed;
  return plan;
}

/// One way to fit all brackets; the error is the mean over the cameras.
Contender contender(Row row, const std::vector<Photographed>& brackets, const Fit& fit) {
  const auto answers = std::make_shared<std::vector<Response>>(brackets.size());
  row.suite = "calibrate";
  row.error_name = "rms of exposure over codes 5 to 250";
  row.error_unit = "%";
  row.megapixels = megapixels(brackets[0].bracket.size());
  return {row,
          [&brackets, fit, answers] {
            for (std::size_t k = 0; k < brackets.size(); ++k) (*answers)[k] = fit(brackets[k].bracket);
          },
          [&brackets, answers] {
            double mean = 0;
            for (std::size_t k = 0; k < brackets.size(); ++k) {
              mean += response_rms((*answers)[k], brackets[k].truth.response) / static_cast<double>(brackets.size());
            }
            return percent_of_ln(mean);
          },
          50};
}

void by_points(Bench& bench) {
  const Size size = bench.pick(Size{480, 320}, Size{1500, 1000});
  std::vector<Photographed> brackets;
  for (int seed = 1; seed <= bench.pick(2, 6); ++seed) {
    brackets.push_back(photographed(plan_of(size, static_cast<std::uint64_t>(seed))));
  }
  const std::string stage = fmt::format("{} film cameras, {} each", brackets.size(), text_of(plan_of(size, 1)));
  const struct {
    CalibrateMethod method;
    const char* name;
  } methods[] = {{CalibrateMethod::kDebevecMalik, "debevec-malik"},
                 {CalibrateMethod::kRobertson, "robertson"},
                 {CalibrateMethod::kMitsunagaNayar, "mitsunaga-nayar"}};
  std::vector<Contender> contenders;
  for (const auto& m : methods) {
    for (const int points : {30, 100, 300, 1000, 3000, 0}) {
      CalibrateOptions options;
      options.pixels = points;
      Row row{"", stage, std::string("hdr ") + m.name, "points"};
      if (points == 0) {
        row.label = "auto";
        row.setting = fmt::format("hdr calibrate shots/ -o response.json --method {}", m.name);
      } else {
        row.value = points;
      }
      contenders.push_back(contender(row, brackets, [options, method = m.method](const Bracket& bracket) {
        return calibrate(method, bracket, {}, options).response;
      }));
    }
  }
#ifdef HDR_RIVAL_OPENCV
  for (const int samples : {30, 70, 200}) {  // its normal equations are dense: a thousand take minutes
    Row row{"", stage, "OpenCV CalibrateDebevec", "points"};
    row.value = samples;
    contenders.push_back(contender(row, brackets, [samples](const Bracket& bracket) {
      return opencv_debevec_response(bracket, samples, threads());
    }));
  }
  Row row{"", stage, "OpenCV CalibrateRobertson", "points"};
  row.label = "all";
  contenders.push_back(contender(
      row, brackets, [](const Bracket& bracket) { return opencv_robertson_response(bracket, 30, threads()); }));
#else
  bench.absent("OpenCV CalibrateDebevec, CalibrateRobertson", "install libopencv-photo-dev and build again");
#endif
  bench.race(std::move(contenders));
}

void by_megapixels(Bench& bench) {
  for (const int width : bench.quick() ? std::vector<int>{150, 300, 600} : std::vector<int>{600, 1200, 2400, 4800}) {
    const BracketPlan plan = plan_of({width, width * 2 / 3}, 1);
    const Photographed made = photographed(plan);
    Row row{"calibrate", "points as many as needed, by size", "hdr debevec-malik", "megapixels"};
    row.value = row.megapixels = megapixels(plan.size);
    bench.race({{row, [&made] { calibrate_debevec_malik(made.bracket); }}});
  }
}

void by_threads(Bench& bench) {
  const BracketPlan plan = plan_of(bench.pick(Size{480, 320}, Size{3000, 2000}), 1);
  const Photographed made = photographed(plan);
  Row row{"calibrate", text_of(plan) + ", by threads", "hdr debevec-malik", "threads"};
  row.megapixels = megapixels(plan.size);
  race_threads(bench, row, [&made] { calibrate_debevec_malik(made.bracket); });
}

}  // namespace

void calibrate_suite(Bench& bench) {
  bench.attempt("calibrate", "by points", [&] { by_points(bench); });
  bench.attempt("calibrate", "by size", [&] { by_megapixels(bench); });
  bench.attempt("calibrate", "by threads", [&] { by_threads(bench); });
}

}  // namespace hdr::bench
