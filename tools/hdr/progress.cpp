#include "tools/hdr/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace hdr::tools {

Progress::Progress(std::string name, bool silent) : name_(std::move(name)) {
  if (!silent && isatty(STDERR_FILENO)) thread_ = std::thread([this] { draw(); });
}

Progress::~Progress() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Progress::draw() {
  const auto start = std::chrono::steady_clock::now();
  bool drawn = false;
  std::unique_lock lock(mutex_);
  for (auto wait = std::chrono::milliseconds(1000); !wake_.wait_for(lock, wait, [this] { return finished_; });
       wait = std::chrono::milliseconds(100)) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double done = done_.load(std::memory_order_relaxed);
    std::string bar;
    if (done >= 0) {
      const auto filled = static_cast<std::size_t>(std::clamp(done, 0.0, 1.0) * 30);
      bar = fmt::format("[{}{}] {:3.0f}% ", std::string(filled, '#'), std::string(30 - filled, '.'), 100 * done);
    }
    fmt::print(stderr, "\r\033[K{:<10} {}{:.1f} s", name_, bar, seconds);
    std::fflush(stderr);
    drawn = true;
  }
  if (drawn) fmt::print(stderr, "\r\033[K");
}

}  // namespace hdr::tools
