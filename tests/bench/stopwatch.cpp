#include "tests/bench/stopwatch.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>

namespace hdr::bench {
namespace {

double cpu_of(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Seconds now() {
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now().time_since_epoch();
  return {wall.count(), cpu_of(RUSAGE_SELF) + cpu_of(RUSAGE_CHILDREN)};
}

Seconds at(const std::vector<Seconds>& runs, double quantile) {
  std::vector<double> wall, cpu;
  for (const Seconds& run : runs) {
    wall.push_back(run.wall);
    cpu.push_back(run.cpu);
  }
  if (runs.empty()) return {};
  std::sort(wall.begin(), wall.end());
  std::sort(cpu.begin(), cpu.end());
  const auto k = static_cast<std::size_t>(quantile * static_cast<double>(runs.size() - 1));
  return {wall[k], cpu[k]};
}

}  // namespace

Stopwatch::Stopwatch() : start_(now()) {}

Seconds Stopwatch::elapsed() const {
  const Seconds end = now();
  return {end.wall - start_.wall, end.cpu - start_.cpu};
}

Seconds Runs::least() const {
  return at(runs_, 0);
}

Seconds Runs::median() const {
  return at(runs_, 0.5);
}

}  // namespace hdr::bench
