#pragma once
// A bar on stderr for work that takes over a second, on a terminal only.
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace hdr::tools {

class Progress {
 public:
  Progress(std::string name, bool silent);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Share done, 0..1, from any thread. Work that never says shows its seconds alone.
  void update(double done) const { done_.store(done, std::memory_order_relaxed); }

 private:
  void draw();

  std::string name_;
  mutable std::atomic<double> done_{-1};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool finished_ = false;
  std::thread thread_;
};

}  // namespace hdr::tools
