#include "tests/bench/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "tests/bench/peak_memory.h"
#include "tests/bench/stopwatch.h"

namespace hdr::bench {
namespace {

constexpr double kShortest = 4e-3;  // s: what takes less is run many times in a row
constexpr int kMostInARow = 2000, kMostRuns = 7, kMostRunsInQuick = 3;

std::string not_timed(const std::exception& e) {
  return std::string("not timed: ") + e.what();
}

/// A contender in its race.
struct Runner {
  Contender* contender = nullptr;
  Seconds first;
  Runs runs;
  int in_a_row = 1, wanted = 0;
  bool failed = false;

  void plan(double budget, int most) {
    const double once = std::max(first.wall, 1e-7);
    in_a_row = std::clamp(static_cast<int>(std::ceil(kShortest / once)), 1, kMostInARow);
    wanted = std::clamp(static_cast<int>(budget / (once * in_a_row)), 0, most);
  }

  /// Work that has succeeded once can fail all the same: a disk fills up, a rival's program is killed.
  void run() {
    try {
      runs.time([&] {
        for (int k = 0; k < in_a_row; ++k) contender->work();
      });
    } catch (const std::exception& e) {
      contender->row.note = not_timed(e);
      failed = true;
    }
  }

  void fill(Row& row) const {
    if (failed) return;
    const bool alone = runs.count() == 0;  // so long that the run that was checked has to do
    const Seconds least = alone ? first : runs.least(), median = alone ? first : runs.median();
    row.cpu_seconds = least.cpu / (alone ? 1 : in_a_row);
    row.median_cpu_seconds = median.cpu / (alone ? 1 : in_a_row);
    row.wall_seconds = least.wall / (alone ? 1 : in_a_row);
  }
};

/// Once, with its memory and its error. Returns false, with the reason in the row, for what is no answer.
bool checked(Contender& contender, Seconds& first) {
  Row& row = contender.row;
  try {
    const PeakMemory peak;
    const Stopwatch watch;
    contender.work();
    first = watch.elapsed();
    row.peak_bytes = peak.bytes();
    if (!contender.error) return true;
    row.error = contender.error();
  } catch (const std::exception& e) {
    row.note = not_timed(e);
    return false;
  }
  if (row.error <= contender.sane) return true;
  row.note = fmt::format("not timed: its answer is wrong ({} {}, more than {})", short_number(row.error),
                         row.error_unit, short_number(contender.sane));
  return false;
}

}  // namespace

std::size_t Bench::race(std::vector<Contender> contenders) {
  const double budget = quick() ? 0.06 : 3;  // s of wall clock for each
  const int most = quick() ? kMostRunsInQuick : kMostRuns;
  std::vector<Runner> runners;
  for (Contender& contender : contenders) {
    if (contender.row.threads == 0) contender.row.threads = hdr::threads();
    Runner runner;
    runner.contender = &contender;
    if (!checked(contender, runner.first)) continue;
    runner.plan(budget, most);
    runners.push_back(std::move(runner));
  }
  for (int round = 0; round < kMostRuns; ++round) {
    for (Runner& runner : runners) {
      if (round < runner.wanted && !runner.failed) runner.run();
    }
  }
  for (const Runner& runner : runners) runner.fill(runner.contender->row);
  const std::size_t first_row = rows_.size();
  for (Contender& contender : contenders) add(std::move(contender.row));
  return first_row;
}

void Bench::attempt(const std::string& suite, const std::string& stage, const std::function<void()>& part) {
  try {
    part();
  } catch (const std::exception& e) {
    Row row{suite, stage, "hdr", "nothing"};
    row.label = "-";
    row.threads = hdr::threads();
    row.note = not_timed(e);
    add(std::move(row));
  }
}

void Bench::add(Row row) {
  rows_.push_back(std::move(row));
}

void Bench::absent(const std::string& name, const std::string& remedy) {
  const auto same = [&](const Absent& other) { return other.name == name; };
  if (std::none_of(absent_.begin(), absent_.end(), same)) absent_.push_back({name, remedy});
}

std::vector<int> thread_counts() {
  std::vector<int> counts;
  const int all = threads();
  for (int count = 1; count < all; count *= 2) counts.push_back(count);
  counts.push_back(all);
  return counts;
}

void race_threads(Bench& bench, const Row& row, const std::function<void()>& work) {
  const int all = threads();
  std::vector<Contender> contenders;
  for (const int count : thread_counts()) {
    Contender contender{row, [work, count] {
                          set_threads(count);
                          work();
                        }};
    contender.row.knob = "threads";
    contender.row.value = count;
    contender.row.threads = count;
    contenders.push_back(std::move(contender));
  }
  bench.race(std::move(contenders));
  set_threads(all);
}

}  // namespace hdr::bench
