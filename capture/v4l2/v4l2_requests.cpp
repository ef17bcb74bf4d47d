#include "capture/v4l2/v4l2_requests.h"

#include <fcntl.h>
#include <linux/media.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <filesystem>

#include "capture/v4l2/v4l2_controls.h"

namespace hdr::v4l2 {
namespace {

namespace fs = std::filesystem;

/// Whether this media device has the video node as one of its interfaces.
bool has_interface(int media, dev_t node) {
  media_v2_topology topology{};
  if (call(media, MEDIA_IOC_G_TOPOLOGY, &topology) != 0) return false;
  std::vector<media_v2_interface> interfaces(topology.num_interfaces);
  media_v2_topology asked{};
  asked.num_interfaces = topology.num_interfaces;
  asked.ptr_interfaces = reinterpret_cast<std::uintptr_t>(interfaces.data());
  if (call(media, MEDIA_IOC_G_TOPOLOGY, &asked) != 0) return false;
  return std::ranges::any_of(interfaces, [&](const media_v2_interface& i) {
    return i.devnode.major == major(node) && i.devnode.minor == minor(node);
  });
}

std::unique_ptr<File> open_media_device_of(const Device& device) {
  struct stat node {};
  std::error_code none;
  if (fstat(device.descriptor(), &node) != 0) return nullptr;
  for (const auto& entry : fs::directory_iterator("/dev", none)) {
    if (!entry.path().filename().string().starts_with("media")) continue;
    auto media = std::make_unique<File>(open(entry.path().c_str(), O_RDWR | O_CLOEXEC));
    if (media->descriptor() >= 0 && has_interface(media->descriptor(), node.st_rdev)) return media;
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<Requests> Requests::make(const Device& device, std::size_t count) {
  const auto media = open_media_device_of(device);
  if (!media) return nullptr;
  std::vector<std::unique_ptr<File>> files;
  for (std::size_t k = 0; k < count; ++k) {
    int request = -1;
    if (call(media->descriptor(), MEDIA_IOC_REQUEST_ALLOC, &request) != 0) return nullptr;
    files.push_back(std::make_unique<File>(request));
  }
  return std::unique_ptr<Requests>(new Requests(std::move(files)));
}

int Requests::queue(int descriptor, v4l2_buffer& buffer, const ControlValues& controls) {
  const int request = files_[buffer.index]->descriptor();
  // One that was queued and has not been finished is set up anew.
  call(request, MEDIA_REQUEST_IOC_REINIT, nullptr);
  for (const auto& [id, value] : controls) {
    if (const int error = set_control(descriptor, id, value, request)) return error;
  }
  buffer.flags |= V4L2_BUF_FLAG_REQUEST_FD;
  buffer.request_fd = request;
  if (const int error = call(descriptor, VIDIOC_QBUF, &buffer)) return error;
  return call(request, MEDIA_REQUEST_IOC_QUEUE, nullptr);
}

ControlValues Requests::finish(int descriptor, std::size_t index, const ControlValues& asked) {
  const int request = files_[index]->descriptor();
  // The buffer may be there a moment before the controls are: the request is complete when both are.
  constexpr int kCompletionMs = 100;
  pollfd complete{request, POLLPRI, 0};
  ControlValues values;
  if (poll(&complete, 1, kCompletionMs) <= 0) return values;
  for (const auto& [id, unused] : asked) {
    std::int64_t value = 0;
    if (get_control(descriptor, id, value, request) == 0) values[id] = value;
  }
  return values;
}

}  // namespace hdr::v4l2
