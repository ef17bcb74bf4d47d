#include "capture/internal/deadline_worker.h"

#include <csignal>
#include <thread>
#include <utility>

namespace hdr::internal {

DeadlineWorker::DeadlineWorker() {
  // Signals are for the program's own threads.
  sigset_t all, old;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &old);
  std::thread([queue = queue_] { work(queue); }).detach();
  pthread_sigmask(SIG_SETMASK, &old, nullptr);
}

DeadlineWorker::~DeadlineWorker() {
  const std::lock_guard lock(queue_->mutex);
  queue_->closing = true;
  queue_->changed.notify_all();
}

void DeadlineWorker::post(std::function<void()> call) {
  const std::lock_guard lock(queue_->mutex);
  queue_->calls.push_back(std::move(call));
  queue_->changed.notify_all();
}

void DeadlineWorker::work(const std::shared_ptr<Queue>& queue) {
  std::unique_lock lock(queue->mutex);
  while (true) {
    queue->changed.wait(lock, [&] { return queue->closing || !queue->calls.empty(); });
    if (queue->calls.empty()) return;
    std::function<void()> call = std::move(queue->calls.front());
    queue->calls.pop_front();
    lock.unlock();
    call();
    call = nullptr;  // what it owned is let go before the next one runs
    lock.lock();
  }
}

}  // namespace hdr::internal
