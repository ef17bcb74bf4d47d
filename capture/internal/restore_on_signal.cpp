#include "capture/internal/restore_on_signal.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace hdr::internal {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM};

// The handler may only write to the pipe; everything else is the watcher's. A forked child has the handler, but neither
// the watcher's thread nor a right to the parent's camera.
int pipe_ends[2] = {-1, -1};
volatile pid_t watched_process = 0;

extern "C" void wake_watcher(int number) {
  if (getpid() != watched_process) {
    signal(number, SIG_DFL);
    raise(number);
    return;
  }
  const auto byte = static_cast<char>(number);
  [[maybe_unused]] const auto written = write(pipe_ends[1], &byte, 1);
}

class Watcher {
 public:
  static Watcher& instance() {
    static Watcher* watcher = nullptr;  // never destroyed: its thread has no end
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    if (!watcher || watched_process != getpid()) watcher = new Watcher;
    return *watcher;
  }

  int add(std::function<void()> restore) {
    const std::lock_guard lock(mutex_);
    if (restores_.empty()) install();
    restores_.emplace(++last_key_, std::move(restore));
    return last_key_;
  }

  void remove(int key) {
    const std::lock_guard lock(mutex_);
    restores_.erase(key);
    if (restores_.empty()) uninstall();
  }

 private:
  Watcher() {
    watched_process = getpid();
    if (pipe2(pipe_ends, O_CLOEXEC) != 0) return;  // no descriptors left: then there is no camera either
    sigset_t all, old;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &old);
    std::thread([this] { watch(); }).detach();
    pthread_sigmask(SIG_SETMASK, &old, nullptr);
  }

  void install() {
    for (std::size_t k = 0; k < kSignals.size(); ++k) {
      struct sigaction ours {};
      ours.sa_handler = wake_watcher;
      sigemptyset(&ours.sa_mask);
      sigaction(kSignals[k], nullptr, &old_[k]);
      ours_[k] = pipe_ends[1] >= 0 && (old_[k].sa_flags & SA_SIGINFO) == 0 && old_[k].sa_handler == SIG_DFL;
      if (ours_[k]) sigaction(kSignals[k], &ours, nullptr);
    }
  }

  void uninstall() {
    for (std::size_t k = 0; k < kSignals.size(); ++k) {
      if (ours_[k]) sigaction(kSignals[k], &old_[k], nullptr);
      ours_[k] = false;
    }
  }

  void watch() {
    char number = 0;
    while (read(pipe_ends[0], &number, 1) != 1) {
    }
    const std::lock_guard lock(mutex_);
    for (const auto& [key, restore] : restores_) restore();
    uninstall();
    kill(getpid(), number);
  }

  std::mutex mutex_;
  std::map<int, std::function<void()>> restores_;
  int last_key_ = 0;
  std::array<struct sigaction, kSignals.size()> old_{};
  std::array<bool, kSignals.size()> ours_{};
};

}  // namespace

RestoreOnSignal::RestoreOnSignal(std::function<void()> restore) : key_(Watcher::instance().add(std::move(restore))) {}

RestoreOnSignal::~RestoreOnSignal() {
  Watcher::instance().remove(key_);
}

}  // namespace hdr::internal
