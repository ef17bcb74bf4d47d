#include "capture/libcamera/shared_manager.h"

#include <libcamera/logging.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "capture/v4l2/v4l2_device.h"

namespace hdr::lc {
namespace {

using namespace std::chrono_literals;

struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::weak_ptr<libcamera::CameraManager> current;
  bool exists = false, ending = false;
};

/// Never destroyed: a camera may be let go on a thread that outlives main().
Shared& shared() {
  static Shared& the = *new Shared;
  return the;
}

void end(libcamera::CameraManager* manager) {
  {
    const std::lock_guard lock(shared().mutex);
    shared().ending = true;
  }
  shared().changed.notify_all();
  manager->stop();
  delete manager;
  const std::lock_guard lock(shared().mutex);
  shared().exists = shared().ending = false;
  shared().changed.notify_all();
}

}  // namespace

std::shared_ptr<libcamera::CameraManager> shared_manager() {
  std::unique_lock lock(shared().mutex);
  if (auto running = shared().current.lock()) return running;
  // The last one may still be ending, on another thread.
  if (!shared().changed.wait_for(lock, 4s, [] { return !shared().exists; })) {
    throw v4l2::error_of(ETIMEDOUT, v4l2::During::kOpen, "libcamera", "starting it");
  }
  // Its errors come back to us as numbers; a line on the person's screen for each camera is too much.
  if (!std::getenv("LIBCAMERA_LOG_LEVELS")) libcamera::logSetTarget(libcamera::LoggingTargetNone);
  auto made = std::make_unique<libcamera::CameraManager>();
  if (made->start() != 0) {
    throw CameraError(CameraError::Kind::kNotSupported, "libcamera does not start on this machine");
  }
  shared().exists = true;
  std::shared_ptr<libcamera::CameraManager> running(made.release(), end);
  shared().current = running;
  return running;
}

void hold_until_manager_ends() {
  {
    std::unique_lock lock(shared().mutex);
    if (!shared().changed.wait_for(lock, 3s, [] { return shared().ending; })) return;
  }
  // stop() first tells this thread to end, then waits for it; nothing shows which of them it is at.
  std::this_thread::sleep_for(50ms);
}

}  // namespace hdr::lc
