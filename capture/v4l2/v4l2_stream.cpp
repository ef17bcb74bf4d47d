#include "capture/v4l2/v4l2_stream.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <utility>
#include <vector>

namespace hdr::v4l2 {

using Clock = std::chrono::steady_clock;
using Kind = CameraError::Kind;
constexpr auto kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;

FrameFormat set_format(Device& device, const FormatCode& code, Size size) {
  v4l2_format format{};
  format.type = kCapture;
  format.fmt.pix.width = static_cast<__u32>(size.width);
  format.fmt.pix.height = static_cast<__u32>(size.height);
  format.fmt.pix.pixelformat = code.fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  device.require(VIDIOC_S_FMT, format, During::kStream, "setting its format");
  const v4l2_pix_format& got = format.fmt.pix;
  const Size got_size{static_cast<int>(got.width), static_cast<int>(got.height)};
  if (got.pixelformat != code.fourcc || got_size != size) {
    throw CameraError(
        Kind::kNotSupported,
        fmt::format("{}: the camera takes {} {}x{} where {} {}x{} was asked; hdr cameras lists its formats",
                    device.uri(), fourcc_text(got.pixelformat), got.width, got.height, fourcc_text(code.fourcc),
                    size.width, size.height));
  }
  FrameFormat result = frame_format(code, size);
  if (result.pixels != PixelFormat::kMjpeg) result.stride_bytes = static_cast<std::ptrdiff_t>(got.bytesperline);
  const bool rgb = result.pixels == PixelFormat::kRgb8;
  std::uint32_t quantization = got.quantization;
  if (quantization == V4L2_QUANTIZATION_DEFAULT) {
    quantization = V4L2_MAP_QUANTIZATION_DEFAULT(rgb, got.colorspace, got.ycbcr_enc);
  }
  result.full_range = quantization == V4L2_QUANTIZATION_FULL_RANGE;
  return result;
}

Intervals frame_intervals(Device& device, std::uint32_t fourcc, Size size) {
  const auto seconds = [](const v4l2_fract& f) {
    return f.denominator ? double{f.numerator * 1.0} / f.denominator : 0.0;
  };
  Intervals found;
  v4l2_frmivalenum interval{};
  interval.pixel_format = fourcc;
  interval.width = static_cast<__u32>(size.width);
  interval.height = static_cast<__u32>(size.height);
  while (device.ask(VIDIOC_ENUM_FRAMEINTERVALS, interval) == 0) {
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE)
      return {seconds(interval.stepwise.min), seconds(interval.stepwise.max)};
    const double one = seconds(interval.discrete);
    found.shortest = interval.index == 0 ? one : std::min(found.shortest, one);
    found.longest = std::max(found.longest, one);
    interval.index += 1;
  }
  return found;
}

double set_frame_interval(Device& device, double seconds) {
  v4l2_streamparm parameters{};
  parameters.type = kCapture;
  constexpr __u32 kMicroseconds = 1'000'000;
  parameters.parm.capture.timeperframe = {static_cast<__u32>(seconds * kMicroseconds), kMicroseconds};
  const int error = device.ask(VIDIOC_S_PARM, parameters);
  if (error == ENOTTY || error == EINVAL) return 0;
  if (error) throw error_of(error, During::kStream, device.uri(), "setting its frame rate");
  const v4l2_fract& got = parameters.parm.capture.timeperframe;
  return got.denominator ? static_cast<double>(got.numerator) / got.denominator : 0;
}

/// The buffers, the kernel's queue of them, and who has which.
struct Stream::Ring {
  struct Buffer {
    void* data = MAP_FAILED;
    std::size_t bytes = 0;
    std::unique_ptr<File> exported;
  };

  std::shared_ptr<File> device;
  std::vector<Buffer> buffers;
  std::unique_ptr<Requests> requests;
  std::mutex mutex;
  ControlValues controls;
  std::size_t held = 0;  ///< buffers that are neither queued nor done
  bool running = false;

  ~Ring() {
    for (const Buffer& buffer : buffers) {
      if (buffer.data != MAP_FAILED) munmap(buffer.data, buffer.bytes);
    }
  }

  int queue(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = kCapture;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    if (requests) return requests->queue(device->descriptor(), buffer, controls);
    return call(device->descriptor(), VIDIOC_QBUF, &buffer);
  }

  /// A frame is let go. After the stream's end there is nothing to give it back to.
  void give_back(std::uint32_t index) {
    const std::lock_guard lock(mutex);
    held -= 1;
    if (running) queue(index);
  }

  int map(std::uint32_t index, bool export_it) {
    v4l2_buffer buffer{};
    buffer.type = kCapture;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    if (const int error = call(device->descriptor(), VIDIOC_QUERYBUF, &buffer)) return error;
    Buffer& own = buffers[index];
    own.bytes = buffer.length;
    own.data = mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, device->descriptor(), buffer.m.offset);
    if (own.data == MAP_FAILED) return errno;
    if (!export_it) return 0;
    v4l2_exportbuffer exported{};
    exported.type = kCapture;
    exported.index = index;
    exported.flags = O_RDONLY | O_CLOEXEC;
    if (const int error = call(device->descriptor(), VIDIOC_EXPBUF, &exported)) return error;
    own.exported = std::make_unique<File>(exported.fd);
    return 0;
  }
};

Stream::Stream(Device& device, const FrameFormat& format, const StreamOptions& options)
    : device_(device), format_(format), ring_(std::make_shared<Ring>()) {
  ring_->device = device.file();
  v4l2_requestbuffers request{};
  request.count = options.buffers;
  request.type = kCapture;
  request.memory = V4L2_MEMORY_MMAP;
  device_.require(VIDIOC_REQBUFS, request, During::kStream, "asking for its buffers");
  ring_->buffers.resize(request.count);
  ring_->controls = options.request_controls;
  for (std::uint32_t k = 0; k < request.count; ++k) {
    if (const int error = ring_->map(k, options.dmabuf))
      throw error_of(error, During::kStream, device_.uri(), "mapping its buffers");
  }
  if (!options.request_controls.empty() && (request.capabilities & V4L2_BUF_CAP_SUPPORTS_REQUESTS) != 0) {
    ring_->requests = Requests::make(device_, request.count);
  }
  const std::lock_guard lock(ring_->mutex);
  for (std::uint32_t k = 0; k < request.count; ++k) {
    if (const int error = ring_->queue(k))
      throw error_of(error, During::kStream, device_.uri(), "queueing its buffers");
  }
  int type = kCapture;
  device_.require(VIDIOC_STREAMON, type, During::kStream, "starting it");
  ring_->running = true;
}

Stream::~Stream() {
  {
    const std::lock_guard lock(ring_->mutex);
    ring_->running = false;
  }
  // Buffers that frames still hold stay mapped until they let go: the kernel keeps them as orphans.
  try {
    device_.run([file = device_.file()] {
      int type = kCapture;
      call(file->descriptor(), VIDIOC_STREAMOFF, &type);
      v4l2_requestbuffers none{};
      none.type = kCapture;
      none.memory = V4L2_MEMORY_MMAP;
      return call(file->descriptor(), VIDIOC_REQBUFS, &none);
    });
  } catch (...) {  // no memory for a call: closing the file ends the stream
  }
}

bool Stream::has_requests() const {
  return ring_->requests != nullptr;
}

void Stream::ask(const ControlValues& controls) {
  const std::lock_guard lock(ring_->mutex);
  for (const auto& [id, value] : controls) ring_->controls[id] = value;
}

void Stream::wait(Clock::time_point deadline) const {
  using std::chrono::milliseconds;
  while (true) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now());
    pollfd ready{device_.descriptor(), POLLIN, 0};
    const int count = poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000)));
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) throw CameraError(Kind::kTimeout, device_.uri() + ": no frame came in time; is its cable sound?");
    if ((ready.revents & POLLHUP) != 0) throw error_of(ENODEV, During::kStream, device_.uri(), "waiting for a frame");
    if ((ready.revents & POLLIN) != 0) return;
    // POLLERR alone: nothing is queued, or the driver has given up.
    const std::lock_guard lock(ring_->mutex);
    if (ring_->held == ring_->buffers.size()) {
      throw CameraError(Kind::kWrongState,
                        device_.uri() + ": all of its buffers are held by frames; detach() those that are kept");
    }
    throw error_of(EIO, During::kStream, device_.uri(), "waiting for a frame");
  }
}

std::optional<Arrived> Stream::take() {
  v4l2_buffer buffer{};
  buffer.type = kCapture;
  buffer.memory = V4L2_MEMORY_MMAP;
  const int error = call(device_.descriptor(), VIDIOC_DQBUF, &buffer);
  if (error == EAGAIN) return std::nullopt;
  if (error) throw error_of(error, During::kStream, device_.uri(), "fetching a frame");
  Arrived arrived;
  {
    const std::lock_guard lock(ring_->mutex);
    ring_->held += 1;
    if (ring_->requests)
      arrived.controls = ring_->requests->finish(device_.descriptor(), buffer.index, ring_->controls);
  }
  const Ring::Buffer& own = ring_->buffers[buffer.index];
  Frame& frame = arrived.frame;
  frame.bytes = {static_cast<const std::uint8_t*>(own.data), std::min<std::size_t>(buffer.bytesused, own.bytes)};
  frame.owner = std::shared_ptr<const void>(
      own.data, [ring = ring_, index = buffer.index](const void*) { ring->give_back(index); });
  frame.dmabuf = own.exported ? own.exported->descriptor() : -1;
  frame.format = format_;
  frame.sequence = buffer.sequence;
  const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  frame.timestamp =
      monotonic ? std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec)
                : Clock::now().time_since_epoch();
  // Leaving gives a bad frame's buffer back.
  if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || !frame.is_whole()) return std::nullopt;
  return arrived;
}

Arrived Stream::next(Clock::time_point deadline) {
  while (true) {
    wait(deadline);
    if (auto arrived = take()) return std::move(*arrived);
  }
}

}  // namespace hdr::v4l2
