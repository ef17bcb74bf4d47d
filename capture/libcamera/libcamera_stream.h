#pragma once
// Requests going round: buffers of one libcamera stream, controls that ride on the next request, frames that arrive.
// Shared with libcamera's callbacks and with frames, which may outlive the camera.
#include <libcamera/libcamera.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "capture/frame.h"

namespace hdr::lc {

class Stream : public std::enable_shared_from_this<Stream> {
 public:
  /// `manager` outlives the camera through it. The camera is configured. Throws std::runtime_error when there is no
  /// memory for buffers.
  Stream(std::shared_ptr<libcamera::CameraManager> manager, std::shared_ptr<libcamera::Camera> camera,
         libcamera::Stream* stream);
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Starts with these controls. 0 or an errno.
  int start(const libcamera::ControlList& controls);
  int stop();
  /// Controls for the next request that is queued.
  void ask(const libcamera::ControlList& controls);

  enum class Arrival { kFrame, kGone, kNothing };
  /// The next request that is complete, as a frame without its format; damaged ones are dropped.
  Arrival next(std::chrono::steady_clock::time_point deadline, Frame& frame,
               std::optional<libcamera::ControlList>& metadata);
  /// Sends a last request with these controls, if one can be had in this time.
  void send_last(const libcamera::ControlList& controls, std::chrono::milliseconds patience);
  bool gone();

 private:
  struct Mapping {
    void* data = nullptr;
    std::size_t bytes = 0;
    int descriptor = -1;
  };
  libcamera::Request* wait_for_request(std::unique_lock<std::mutex>& lock,
                                       std::chrono::steady_clock::time_point deadline);
  void give_back(libcamera::Request* request);
  void queue(libcamera::Request* request);
  void map(libcamera::FrameBuffer& buffer);

  std::shared_ptr<libcamera::CameraManager> manager_;
  std::shared_ptr<libcamera::Camera> camera_;
  libcamera::Stream* stream_;
  libcamera::FrameBufferAllocator allocator_;
  std::vector<Mapping> mappings_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<libcamera::Request*> complete_;
  std::optional<libcamera::ControlList> pending_;
  bool running_ = false, gone_ = false;
};

}  // namespace hdr::lc
