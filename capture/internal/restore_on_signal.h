#pragma once
// A program that is ended by SIGINT or SIGTERM gives the camera its settings back first.
#include <functional>
#include <memory>

namespace hdr::internal {

/// While one lives, and the program has no handler of its own (one that has lives on, and stops its cameras), a signal
/// runs `restore` on another thread and then ends the program as it would have. `restore` must own what it touches,
/// take no lock that is held for long, and not throw.
class RestoreOnSignal {
 public:
  explicit RestoreOnSignal(std::function<void()> restore);
  ~RestoreOnSignal();
  RestoreOnSignal(const RestoreOnSignal&) = delete;
  RestoreOnSignal& operator=(const RestoreOnSignal&) = delete;

 private:
  int key_;
};

}  // namespace hdr::internal
