#pragma once
// An open V4L2 device: its file, calls with deadlines, and errors in words.
#include <chrono>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>

#include "capture/camera.h"
#include "capture/internal/deadline_worker.h"

namespace hdr::v4l2 {

/// What was asked of a device when it answered with an errno: the same number means different things.
enum class During { kOpen, kControl, kStream };
CameraError::Kind error_kind(int error, During during);
/// "v4l2:/dev/video0: WHAT: fact; remedy".
CameraError error_of(int error, During during, const std::string& uri, const std::string& what);

/// A file descriptor, closed with its last owner.
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// ioctl() that goes on after signals: 0 or an errno.
int call(int descriptor, unsigned long request, void* argument);

class Device {
 public:
  /// `uri` names it in errors. Throws CameraError, also when `path` is no device that captures in single-planar
  /// buffers.
  Device(std::string uri, const std::string& path);

  const std::string& uri() const { return uri_; }
  const std::string& name() const { return name_; }
  const std::string& bus() const { return bus_; }
  int descriptor() const { return file_->descriptor(); }
  std::shared_ptr<File> file() const { return file_; }

  /// How long a call may take that waits for the device itself.
  static constexpr std::chrono::milliseconds kPatience{2000};

  /// A call that may wait for the device: 0 or an errno; ETIMEDOUT after kPatience, and then the call may still take
  /// place. `argument` must not point to anything.
  template <typename T>
  int ask(unsigned long request, T& argument) {
    auto owned = std::make_shared<T>(argument);
    const int error = run([file = file_, request, owned] { return call(file->descriptor(), request, owned.get()); });
    if (error != ETIMEDOUT) argument = *owned;
    return error;
  }
  /// The same for any call that owns what it uses.
  int run(std::function<int()> call);
  template <typename T>
  void require(unsigned long request, T& argument, During during, const std::string& what) {
    if (const int error = ask(request, argument)) throw error_of(error, during, uri_, what);
  }

 private:
  std::string uri_, name_, bus_;
  internal::DeadlineWorker worker_;
  std::shared_ptr<File> file_;
};

}  // namespace hdr::v4l2
