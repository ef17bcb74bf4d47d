#pragma once
// Frames from a V4L2 device: a format, a ring of mapped buffers, and the good ones of what arrives.
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "capture/frame.h"
#include "capture/v4l2/formats.h"
#include "capture/v4l2/v4l2_device.h"
#include "capture/v4l2/v4l2_requests.h"

namespace hdr::v4l2 {

struct StreamOptions {
  bool dmabuf = false;             ///< export the buffers; kNotSupported where the device cannot
  ControlValues request_controls;  ///< not empty: bind these to each frame where the device offers requests
  std::uint32_t buffers = 6;       ///< the device may round it
};

/// Sets the device's format and returns what it made of it. Throws kNotSupported for another pixel format or size.
FrameFormat set_format(Device& device, const FormatCode& code, Size size);

/// Shortest and longest times from frame to frame that the device offers for a format, in seconds; {0, 0} where it does
/// not say.
struct Intervals {
  double shortest = 0, longest = 0;
};
Intervals frame_intervals(Device& device, std::uint32_t fourcc, Size size);
/// Asks for a time from frame to frame; the device rounds it. Returns what it is, 0 where the device does not say.
double set_frame_interval(Device& device, double seconds);

struct Arrived {
  Frame frame;
  ControlValues controls;  ///< of this frame, where it was a request
};

/// Streams while it lives. Frames may outlive it.
class Stream {
 public:
  Stream(Device& device, const FrameFormat& format, const StreamOptions& options);
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Whether controls are bound to frames.
  bool has_requests() const;
  /// Controls of the frames to come, where has_requests().
  void ask(const ControlValues& controls);

  /// The next whole and undamaged frame. Throws kTimeout, kDisconnected, and kWrongState when all buffers are still
  /// held by frames.
  Arrived next(std::chrono::steady_clock::time_point deadline);

 private:
  struct Ring;
  void wait(std::chrono::steady_clock::time_point deadline) const;
  std::optional<Arrived> take();

  Device& device_;
  FrameFormat format_;
  std::shared_ptr<Ring> ring_;  ///< shared with the frames
};

}  // namespace hdr::v4l2
