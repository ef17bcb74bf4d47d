#include "capture/libcamera/libcamera_stream.h"

#include <sys/mman.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "capture/libcamera/shared_manager.h"

namespace hdr::lc {

Stream::Stream(std::shared_ptr<libcamera::CameraManager> manager, std::shared_ptr<libcamera::Camera> camera,
               libcamera::Stream* stream)
    : manager_(std::move(manager)), camera_(std::move(camera)), stream_(stream), allocator_(camera_) {
  if (allocator_.allocate(stream_) < 0) throw std::runtime_error("no buffers");
  for (const auto& buffer : allocator_.buffers(stream_)) {
    map(*buffer);
    auto request = camera_->createRequest(mappings_.size() - 1);
    if (!request || request->addBuffer(stream_, buffer.get()) != 0) throw std::runtime_error("no requests");
    requests_.push_back(std::move(request));
  }
  camera_->requestCompleted.connect(this, [this](libcamera::Request* request) {
    if (request->status() == libcamera::Request::RequestCancelled) return;
    const std::lock_guard lock(mutex_);
    complete_.push_back(request);
    changed_.notify_all();
  });
  camera_->disconnected.connect(this, [this] {
    bool requests_are_on_their_way = false;
    {
      const std::lock_guard lock(mutex_);
      gone_ = true;
      requests_are_on_their_way = running_;
      changed_.notify_all();
    }
    if (requests_are_on_their_way) hold_until_manager_ends();  // nothing of this object after it: it may be no more
  });
}

Stream::~Stream() {
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  for (const Mapping& mapping : mappings_) munmap(mapping.data, mapping.bytes);
}

void Stream::map(libcamera::FrameBuffer& buffer) {
  // Our formats have one plane; its memory may begin inside the file.
  Mapping mapping;
  for (const auto& plane : buffer.planes()) {
    mapping.bytes = std::max<std::size_t>(mapping.bytes, std::size_t{plane.offset} + plane.length);
    mapping.descriptor = plane.fd.get();
  }
  mapping.data = mmap(nullptr, mapping.bytes, PROT_READ, MAP_SHARED, mapping.descriptor, 0);
  if (mapping.data == MAP_FAILED) throw std::runtime_error("its buffers cannot be mapped");
  mappings_.push_back(mapping);
}

int Stream::start(const libcamera::ControlList& controls) {
  // 0.0.3 ignores the controls of start() for USB cameras: the first request has them too.
  libcamera::ControlList first = controls;
  if (const int error = camera_->start(&first)) return -error;
  const std::lock_guard lock(mutex_);
  pending_ = controls;
  running_ = true;
  for (const auto& request : requests_) queue(request.get());
  return 0;
}

int Stream::stop() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  const int error = camera_->stop();
  const std::lock_guard lock(mutex_);
  complete_.clear();
  return -error;
}

void Stream::ask(const libcamera::ControlList& controls) {
  const std::lock_guard lock(mutex_);
  pending_ = controls;
}

bool Stream::gone() {
  const std::lock_guard lock(mutex_);
  return gone_;
}

void Stream::queue(libcamera::Request* request) {
  if (pending_) request->controls() = *pending_;
  pending_.reset();
  camera_->queueRequest(request);
}

void Stream::give_back(libcamera::Request* request) {
  const std::lock_guard lock(mutex_);
  if (!running_ || gone_) return;
  request->reuse(libcamera::Request::ReuseBuffers);
  queue(request);
}

libcamera::Request* Stream::wait_for_request(std::unique_lock<std::mutex>& lock,
                                             std::chrono::steady_clock::time_point deadline) {
  changed_.wait_until(lock, deadline, [this] { return gone_ || !complete_.empty(); });
  if (complete_.empty()) return nullptr;
  libcamera::Request* const request = complete_.front();
  complete_.pop_front();
  return request;
}

Stream::Arrival Stream::next(std::chrono::steady_clock::time_point deadline, Frame& frame,
                             std::optional<libcamera::ControlList>& metadata) {
  while (true) {
    libcamera::Request* request = nullptr;
    {
      std::unique_lock lock(mutex_);
      request = wait_for_request(lock, deadline);
      if (!request) return gone_ ? Arrival::kGone : Arrival::kNothing;
    }
    const libcamera::FrameBuffer& buffer = *request->buffers().begin()->second;
    const libcamera::FrameMetadata& about = buffer.metadata();
    if (about.status != libcamera::FrameMetadata::FrameSuccess) {
      give_back(request);
      continue;
    }
    const Mapping& mapping = mappings_[request->cookie()];
    std::size_t used = 0;
    for (const auto& plane : about.planes()) used += plane.bytesused;
    const std::size_t offset = buffer.planes().front().offset;
    frame.bytes = {static_cast<const std::uint8_t*>(mapping.data) + offset, std::min(used, mapping.bytes - offset)};
    frame.owner = std::shared_ptr<const void>(
        mapping.data, [self = shared_from_this(), request](const void*) { self->give_back(request); });
    frame.dmabuf = mapping.descriptor;
    frame.sequence = about.sequence;
    frame.timestamp = std::chrono::nanoseconds(about.timestamp);
    const auto& said = request->metadata();
    metadata = said;
    return Arrival::kFrame;
  }
}

void Stream::send_last(const libcamera::ControlList& controls, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (!running_ || gone_) return;
  libcamera::Request* const request = wait_for_request(lock, std::chrono::steady_clock::now() + patience);
  if (!request) return;
  pending_ = controls;
  request->reuse(libcamera::Request::ReuseBuffers);
  queue(request);
}

}  // namespace hdr::lc
