#pragma once
// Calls that may hang in the kernel: a USB control transfer that a camera never answers holds its caller for 5 s, and
// no signal ends it. They run on a thread of their own, and who asked waits no longer than the deadline.
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>

namespace hdr::internal {

class DeadlineWorker {
 public:
  DeadlineWorker();
  /// Does not wait: a call that hangs ends in its own time, then the thread.
  ~DeadlineWorker();
  DeadlineWorker(const DeadlineWorker&) = delete;
  DeadlineWorker& operator=(const DeadlineWorker&) = delete;

  /// What `call` returns or throws; nothing when it has not ended by the deadline: it goes on, and later calls come
  /// after it. So it must own all that it touches.
  template <typename Result>
  std::optional<Result> run(std::function<Result()> call, std::chrono::steady_clock::time_point deadline) {
    auto task = std::make_shared<std::packaged_task<Result()>>(std::move(call));
    std::future<Result> result = task->get_future();
    post([task] { (*task)(); });
    if (result.wait_until(deadline) != std::future_status::ready) return std::nullopt;
    return result.get();
  }

 private:
  struct Queue {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::function<void()>> calls;
    bool closing = false;
  };
  void post(std::function<void()> call);
  static void work(const std::shared_ptr<Queue>& queue);

  std::shared_ptr<Queue> queue_ = std::make_shared<Queue>();
};

}  // namespace hdr::internal
