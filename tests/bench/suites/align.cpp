// Registration of shaken brackets: how far off, at what cost.
#include "libhdr/align/align.h"

#include <fmt/format.h>

#include <algorithm>

#include "libhdr/core/parallel.h"
#include "libhdr/response/calibrate.h"
#include "tests/bench/film.h"
#include "tests/bench/hand_shake.h"
#include "tests/bench/rivals/rival.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/photographed.h"
#include "tests/bench/suites/suite.h"

namespace hdr::bench {
namespace {

constexpr int kShots = 7;
constexpr double kSane = 20;  // px: where nothing was found, the identity is some 6 px off

using Motions = std::vector<Mat3>;  ///< ref_from_photo of each shot
struct Found {
  Motions motions;
  int reference = 0;
};

Photographed shaken(Size size, std::uint64_t seed) {
  BracketPlan plan;
  plan.size = size;
  plan.evs = uniform_evs(kShots, 2);
  plan.response = seed % 2 == 0 ? srgb_response(8) : random_film_response(seed);
  plan.seed = seed;
  plan.scene_from_photo = hand_shake(size, kShots, 12, 0.2, seed);
  return photographed(plan);
}

/// Medians over the picture, in pixels, of the shots that show enough; the reference left out.
void append_distances(const Found& found, const Bracket& bracket, std::uint64_t seed, std::vector<double>& all) {
  constexpr double kFewestUsable = 0.02;
  const Motions truth = hand_shake(bracket.size(), kShots, 12, 0.2, seed);
  const auto reference = static_cast<std::size_t>(found.reference);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    if (k == reference || usable_share(bracket.shots[k]) < kFewestUsable) continue;
    const Mat3 ref_from_photo = truth[reference].inverse() * truth[k];
    const std::vector<double> far = motion_distances(ref_from_photo, found.motions[k], bracket.size());
    all.push_back(far[far.size() / 2]);
  }
}

/// One way to register all brackets.
Contender contender(const std::string& stage, const std::string& subject, const std::vector<Photographed>& brackets,
                    const std::function<Found(const Bracket&)>& registered) {
  const auto answers = std::make_shared<std::vector<Found>>(brackets.size());
  Row row{"align", stage, subject, "method"};
  row.label = subject;
  row.error_name = "median shot";
  row.error_unit = "px";
  row.megapixels = megapixels(brackets[0].bracket.size());
  return {row,
          [&brackets, registered, answers] {
            for (std::size_t k = 0; k < brackets.size(); ++k) (*answers)[k] = registered(brackets[k].bracket);
          },
          [&brackets, answers] {
            std::vector<double> all;
            for (std::size_t k = 0; k < brackets.size(); ++k) {
              append_distances((*answers)[k], brackets[k].bracket, k + 1, all);
            }
            std::sort(all.begin(), all.end());
            return all.empty() ? kUnknown : all[all.size() / 2];
          },
          kSane};
}

Found ours(const Bracket& bracket, AlignMethod method) {
  const Alignment alignment = align(bracket, provisional_response(bracket), method);
  return {alignment.ref_from_photo(), alignment.reference};
}

void by_method(Bench& bench) {
  const Size size = bench.pick(Size{600, 400}, Size{3000, 2000});
  std::vector<Photographed> brackets;
  for (std::uint64_t seed = 1; seed <= bench.pick(1u, 4u); ++seed) brackets.push_back(shaken(size, seed));
  const std::string stage = fmt::format("{} hand-held brackets of {} JPEGs of {}x{}, up to 12 px and .2 degrees",
                                        brackets.size(), kShots, size.width, size.height);
  std::vector<Contender> contenders;
  const struct {
    AlignMethod method;
    const char* name;
  } methods[] = {{AlignMethod::kAuto, "auto"},
                 {AlignMethod::kMtb, "mtb"},
                 {AlignMethod::kEcc, "ecc"},
                 {AlignMethod::kFeatures, "features"}};
  for (const auto& m : methods) {
    contenders.push_back(contender(stage, std::string("hdr ") + m.name, brackets,
                                   [method = m.method](const Bracket& bracket) { return ours(bracket, method); }));
    contenders.back().row.label = m.name;
    contenders.back().row.setting = fmt::format("hdr align shots/ --method {}", m.name);
  }
  const auto rivals = available_align_rivals();
  for (const auto& rival : rivals) {
    contenders.push_back(contender(stage, rival->name(), brackets, [&rival](const Bracket& bracket) {
      return Found{rival->run(bracket, threads()), (kShots - 1) / 2};
    }));
    contenders.back().row.label = "its own";
  }
  if (rivals.empty()) bench.absent("OpenCV AlignMTB", "install libopencv-photo-dev and build again");
  bench.race(std::move(contenders));
}

void by_megapixels(Bench& bench) {
  for (const int width : bench.quick() ? std::vector<int>{200, 400, 600} : std::vector<int>{600, 1200, 2400, 4800}) {
    const Photographed made = shaken({width, width * 2 / 3}, 2);
    Row row{"align", fmt::format("{} JPEGs, by size", kShots), "hdr auto", "megapixels"};
    row.value = row.megapixels = megapixels(made.bracket.size());
    bench.race({{row, [&made] { ours(made.bracket, AlignMethod::kAuto); }}});
  }
}

void by_threads(Bench& bench) {
  const Photographed made = shaken(bench.pick(Size{600, 400}, Size{3000, 2000}), 2);
  Row row{"align", fmt::format("{} JPEGs, by threads", kShots), "hdr auto", "threads"};
  row.megapixels = megapixels(made.bracket.size());
  race_threads(bench, row, [&made] { ours(made.bracket, AlignMethod::kAuto); });
}

}  // namespace

void align_suite(Bench& bench) {
  bench.attempt("align", "by method", [&] { by_method(bench); });
  bench.attempt("align", "by size", [&] { by_megapixels(bench); });
  bench.attempt("align", "by threads", [&] { by_threads(bench); });
}

}  // namespace hdr::bench
