#pragma once
// The Request API: controls that are bound to one frame, and read back with it. Where a driver has it, a frame says
// itself what it was exposed with. Documentation: userspace-api/media/mediactl/request-api.
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "capture/v4l2/v4l2_device.h"

struct v4l2_buffer;

namespace hdr::v4l2 {

using ControlValues = std::map<std::uint32_t, std::int64_t>;

class Requests {
 public:
  /// One request for each of `count` buffers. nullptr where the device has no media device to ask, or that gives none.
  static std::unique_ptr<Requests> make(const Device& device, std::size_t count);

  /// Queues the buffer with these controls. 0 or an errno.
  int queue(int descriptor, v4l2_buffer& buffer, const ControlValues& controls);
  /// What the frame in buffer `index`, which was dequeued, had of these controls; the request may then be used again.
  ControlValues finish(int descriptor, std::size_t index, const ControlValues& asked);

 private:
  explicit Requests(std::vector<std::unique_ptr<File>> files) : files_(std::move(files)) {}
  std::vector<std::unique_ptr<File>> files_;
};

}  // namespace hdr::v4l2
