#include "libhdr/core/stage.h"

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

StageClock::Timing::Timing(StageClock& clock, const std::string& name)
    : clock_(clock), index_(clock.stages_.size()), wall_(wall_now()), cpu_(cpu_now()) {
  clock_.stages_.push_back({name, 0, 0, ""});
}

StageClock::Timing::~Timing() {
  Stage& stage = clock_.stages_[index_];
  stage.seconds = wall_now() - wall_;
  stage.cpu_seconds = cpu_now() - cpu_;
}

void StageClock::skipped(const std::string& reason) {
  if (stages_.empty()) return;
  std::string& text = stages_.back().skipped;
  text += text.empty() ? reason : "; " + reason;
}

}  // namespace hdr
