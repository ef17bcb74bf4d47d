// Brackets to maps: what more shots buy, what others need for the same, and how it scales.
#include "libhdr/merge/merge.h"

#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/io/read.h"
#include "libhdr/response/calibrate.h"
#include "tests/bench/merged_rows.h"
#include "tests/bench/rivals/programs.h"
#include "tests/bench/rivals/rival.h"
#include "tests/bench/score.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/photographed.h"
#include "tests/bench/suites/suite.h"
#include "tests/bench/textbook_merge.h"
#ifdef HDR_RIVAL_OPENCV
#include "tests/bench/rivals/opencv_debevec.h"
#endif

namespace hdr::bench {
namespace {

constexpr double kSane = 30;  // %: a map whose median sample is farther off is none

/// The median of |log2| in percent.
double percent_off(View<const float> map, const Truth& truth) {
  const int step = megapixels(map.size()) > 4 ? 2 : 1;
  return percent_of_ln(std::log(2.0) * score_map(map, truth, step).median);
}

Row row_of(const std::string& stage, const std::string& subject, Size size) {
  Row row{"merge", stage, subject, "shots"};
  row.error_name = "median, of samples that a shot exposes well";
  row.error_unit = "%";
  row.megapixels = megapixels(size);
  return row;
}

/// One way from the bracket to a map.
Contender contender(Row row, const Photographed& made, std::function<Image<float>(const Bracket&)> merged) {
  const auto answer = std::make_shared<Image<float>>();
  row.value = static_cast<double>(made.bracket.shots.size());
  return {std::move(row), [answer, merged, &made] { *answer = merged(made.bracket); },
          [answer, &made] { return percent_off(*answer, made.truth); }, kSane};
}

Image<float> merged_as(const Bracket& bracket, const Response& response, WeightKind weight) {
  MergeOptions options;
  options.weight = weight;
  return merge(bracket, no_alignment(bracket), response, options).map.rgb;
}

/// More shots over the same eight stops, the response known: lossless photographs of one scene.
void by_shots(Bench& bench) {
  const Size size = bench.pick(Size{480, 320}, Size{2400, 1600});
  std::vector<Photographed> brackets;
  for (const int count : {2, 3, 5, 9, 17}) {
    BracketPlan plan;
    plan.size = size;
    plan.evs = uniform_evs(count, 8.0 / (count - 1));
    if (count == 2) plan.evs = {-4, 4};
    plan.response = srgb_response(8);
    plan.format = "png";
    brackets.push_back(photographed(plan));
  }
  const std::string stage = fmt::format("merging alone, the response known, PNGs of {}x{}", size.width, size.height);
  std::vector<Contender> contenders;
  for (const Photographed& made : brackets) {
    const Response& response = made.truth.response;
    Row likely = row_of(stage, "hdr maximum likelihood", size), hat = row_of(stage, "hdr hat", size);
    likely.setting = fmt::format("hdr merge {}-shots/ -o map.exr", made.bracket.shots.size());
    hat.setting = likely.setting + " --weight hat";
    contenders.push_back(contender(
        likely, made, [&response](const Bracket& b) { return merged_as(b, response, WeightKind::kVariance); }));
    contenders.push_back(
        contender(hat, made, [&response](const Bracket& b) { return merged_as(b, response, WeightKind::kHat); }));
    contenders.push_back(contender(row_of(stage, "hdr reference", size), made, [&response](const Bracket& b) {
      return merged_rows(b, response, WeightKind::kVariance, RowKernel::kReference).rgb;
    }));
    contenders.push_back(contender(row_of(stage, "textbook [Debevec97]", size), made,
                                   [&response](const Bracket& b) { return textbook_merge(b, response); }));
#ifdef HDR_RIVAL_OPENCV
    for (const auto& [name, method] : {std::pair("OpenCV MergeDebevec", OpenCvMerge::kDebevec),
                                       std::pair("OpenCV MergeRobertson", OpenCvMerge::kRobertson)}) {
      const auto keep = std::make_shared<RivalAnswer>();
      Contender theirs = contender(row_of(stage, name, size), made, {});
      theirs.work = [keep, &made, &response, method = method] {
        *keep = opencv_merge(made.bracket, response, method, threads());
      };
      theirs.error = [keep, &made] { return percent_off(keep->map, made.truth); };
      contenders.push_back(std::move(theirs));
    }
#endif
  }
  bench.race(std::move(contenders));
}

Photographed nine_jpegs(Size size) {
  BracketPlan plan;
  plan.size = size;
  plan.evs = uniform_evs(9, 2);
  plan.response = srgb_response(8);
  return photographed(plan);
}

Image<float> calibrated_and_merged(const Bracket& bracket) {
  return merge(bracket, no_alignment(bracket), calibrate_debevec_malik(bracket).response).map.rgb;
}

/// The whole of it, on decoded shots: what another library needs for response and map.
void against_libraries(Bench& bench) {
  const Size size = bench.pick(Size{600, 400}, Size{6000, 4000});
  const Photographed made = nine_jpegs(size);
  const std::string stage = fmt::format("calibrating and merging 9 JPEGs of {}x{}", size.width, size.height);
  std::vector<Contender> contenders;
  contenders.push_back(contender(row_of(stage, "hdr", size), made, calibrated_and_merged));
  const auto rivals = available_rivals();
  for (const auto& rival : rivals) {
    const auto keep = std::make_shared<RivalAnswer>();
    Contender theirs = contender(row_of(stage, rival->name(), size), made, {});
    theirs.work = [keep, &made, &rival] { *keep = rival->run(made.bracket, threads()); };
    theirs.error = [keep, &made] { return percent_off(keep->map, made.truth); };
    contenders.push_back(std::move(theirs));
  }
  if (rivals.empty()) bench.absent("OpenCV's photo module", "install libopencv-photo-dev and build again");
  bench.race(std::move(contenders));
}

/// Commands, from files to a file.
void against_programs(Bench& bench) {
  const Size size = bench.pick(Size{480, 320}, Size{3000, 2000});
  const Photographed made = nine_jpegs(size);
  const ShotFiles shots{made.files, made.truth.seconds};
  const std::string stage = fmt::format("commands: 9 JPEGs of {}x{} to an EXR", size.width, size.height);
  const auto add = [&](std::vector<Contender>& all, Row row, const Path& output, std::function<void()> work) {
    row.value = 9;
    all.push_back({std::move(row), std::move(work),
                   [output, &made] { return percent_off(read_map(output, {NonFinite::kKeep}).map.rgb, made.truth); },
                   kSane});
  };
  std::vector<Contender> contenders;
  const Path ours = *made.folder / "hdr.exr";
  std::vector<std::string> line = {
      "/proc/self/exe", "merge",     (*made.folder / "shots").string(), "-o", ours.string(),
      "--quiet",        "--threads", std::to_string(threads())};
  line[0] = std::filesystem::read_symlink("/proc/self/exe").string();
  Row row = row_of(stage, "hdr merge", size);
  row.setting = "hdr merge shots/ -o map.exr";
  add(contenders, row, ours, [line] {
    const support::ProgramResult result = support::run_program(line);
    if (result.exit_code != 0) throw Error("hdr merge failed: " + result.err);
  });
  const auto programs = merge_programs();
  for (const auto& program : programs) {
    if (!find_program(program->program())) {
      bench.absent(program->name(), "apt-get install " + program->package());
      continue;
    }
    const Path output = *made.folder / (program->package() + ".exr");
    add(contenders, row_of(stage, program->name(), size), output,
        [&program, &shots, output, &made] { program->run(shots, output, made.folder->path()); });
  }
  bench.race(std::move(contenders));
}

void by_megapixels(Bench& bench) {
  for (const int width : bench.quick() ? std::vector<int>{150, 300, 600} : std::vector<int>{600, 1200, 2400, 4800}) {
    const Size size{width, width * 2 / 3};
    const Photographed made = nine_jpegs(size);
    Row row{"merge", "merging 9 JPEGs, the response known, by size", "hdr", "megapixels"};
    row.value = row.megapixels = megapixels(size);
    bench.race({{row, [&made] { merge(made.bracket, no_alignment(made.bracket), made.truth.response); }}});
  }
}

void by_threads(Bench& bench) {
  const Photographed made = nine_jpegs(bench.pick(Size{600, 400}, Size{4800, 3200}));
  Row row{"merge", "merging 9 JPEGs, the response known, by threads", "hdr", "threads"};
  row.megapixels = megapixels(made.bracket.size());
  race_threads(bench, row, [&made] { merge(made.bracket, no_alignment(made.bracket), made.truth.response); });
}

}  // namespace

void merge_suite(Bench& bench) {
  bench.attempt("merge", "by shots", [&] { by_shots(bench); });
  bench.attempt("merge", "libraries", [&] { against_libraries(bench); });
  bench.attempt("merge", "commands", [&] { against_programs(bench); });
  bench.attempt("merge", "by size", [&] { by_megapixels(bench); });
  bench.attempt("merge", "by threads", [&] { by_threads(bench); });
}

}  // namespace hdr::bench
