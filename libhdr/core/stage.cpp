#include "libhdr/core/stage.h"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace hdr {
namespace {

double wall_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_now() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

Stopwatch::Stopwatch() : wall_(wall_now()), cpu_(cpu_now()) {}

double Stopwatch::seconds() const {
  return wall_now() - wall_;
}

double Stopwatch::cpu_seconds() const {
  return cpu_now() - cpu_;
}

StageClock::Timing::Timing(StageClock& clock, const std::string& name) : clock_(clock), index_(clock.stages_.size()) {
  clock_.stages_.push_back({name, 0, 0, ""});
}

StageClock::Timing::~Timing() {
  Stage& stage = clock_.stages_[index_];
  stage.seconds = watch_.seconds();
  stage.cpu_seconds = watch_.cpu_seconds();
}

void StageClock::split(const std::string& name, double seconds, double cpu_seconds) {
  if (!stages_.empty()) {
    Stage& from = stages_.back();
    from.seconds = std::max(0.0, from.seconds - seconds);
    from.cpu_seconds = std::max(0.0, from.cpu_seconds - cpu_seconds);
  }
  stages_.push_back({name, seconds, cpu_seconds, ""});
}

void StageClock::skipped(const std::string& reason) {
  if (stages_.empty()) return;
  std::string& text = stages_.back().skipped;
  text += text.empty() ? reason : "; " + reason;
}

}  // namespace hdr
