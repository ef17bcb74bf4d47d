#include "capture/v4l2/v4l2_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace hdr::v4l2 {

using Kind = CameraError::Kind;

CameraError::Kind error_kind(int error, During during) {
  switch (error) {
    case ENODEV:
    case ENXIO:
    case ESHUTDOWN:
    case EPROTO:
    case EIO:
      return Kind::kDisconnected;
    case EACCES:
    case EPERM:
      // For a control this is its automatic mode, which must be switched off first.
      return during == During::kControl ? Kind::kWrongState : Kind::kPermission;
    case EBUSY:
      return Kind::kBusy;
    case ETIMEDOUT:
    case EAGAIN:
      return Kind::kTimeout;
    default:
      return Kind::kNotSupported;
  }
}

CameraError error_of(int error, During during, const std::string& uri, const std::string& what) {
  const Kind kind = error_kind(error, during);
  const auto fact = [&]() -> std::string {
    switch (kind) {
      case Kind::kDisconnected:
        return "the camera is gone; was it unplugged?";
      case Kind::kPermission:
        return "not allowed; add yourself to the group video";
      case Kind::kBusy:
        return during == During::kControl ? "the camera says that it is not ready; try again"
                                          : "another program uses the camera; close it";
      case Kind::kWrongState:
        return "an automatic mode holds it";
      case Kind::kTimeout:
        return fmt::format("no answer within {} s; unplug the camera and plug it in again",
                           std::chrono::duration<double>(Device::kPatience).count());
      case Kind::kNotSupported:
        break;
    }
    if (error == ENOENT) return "there is no such device; hdr cameras lists those that are connected";
    return error == EPIPE ? "the camera refuses it" : std::strerror(error);
  };
  return {kind, fmt::format("{}: {}: {}", uri, what, fact())};
}

File::~File() {
  if (descriptor_ >= 0) close(descriptor_);
}

int call(int descriptor, unsigned long request, void* argument) {
  int result;
  do {
    result = ioctl(descriptor, request, argument);
  } while (result < 0 && errno == EINTR);
  return result < 0 ? errno : 0;
}

int Device::run(std::function<int()> call) {
  return worker_.run<int>(std::move(call), std::chrono::steady_clock::now() + kPatience).value_or(ETIMEDOUT);
}

Device::Device(std::string uri, const std::string& path) : uri_(std::move(uri)) {
  // Opening wakes a sleeping USB device, which may hang as any transfer.
  struct Opened {
    std::shared_ptr<File> file;
    int error;
  };
  const auto opened = worker_.run<Opened>(
      [path] {
        const int descriptor = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        return Opened{std::make_shared<File>(descriptor), descriptor < 0 ? errno : 0};
      },
      std::chrono::steady_clock::now() + kPatience);
  const int error = opened ? opened->error : ETIMEDOUT;
  if (error) throw error_of(error, During::kOpen, uri_, "opening it");
  file_ = opened->file;
  v4l2_capability capability{};
  if (ask(VIDIOC_QUERYCAP, capability) != 0) {
    throw CameraError(Kind::kNotSupported,
                      uri_ + ": this is no video device; hdr cameras lists those that are connected");
  }
  const auto text = [](const __u8* from) { return std::string(reinterpret_cast<const char*>(from)); };
  name_ = text(capability.card);
  bus_ = text(capability.bus_info);
  const unsigned has =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((has & V4L2_CAP_VIDEO_CAPTURE) == 0 || (has & V4L2_CAP_STREAMING) == 0) {
    throw CameraError(Kind::kNotSupported, uri_ + ": this device takes no pictures that V4L2 alone can fetch; " +
                                               "hdr cameras lists those that do");
  }
}

}  // namespace hdr::v4l2
