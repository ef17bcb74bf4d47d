#include "tests/camera/uvc/usbip.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace hdr::sim {
namespace {

/// A header is twelve big-endian words; the set-up packet in the last two is bytes.
using Header = std::array<std::uint32_t, 12>;
enum Word {
  kCommand,
  kSequence,
  kDevice,
  kDirection,
  kEndpoint,
  kFlagsOrStatus,
  kLength,
  kStart,
  kPackets,
  kInterval,
  kSetup
};
enum Command : std::uint32_t { kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4 };

std::span<std::uint8_t> bytes_of(Header& header) {
  return {reinterpret_cast<std::uint8_t*>(header.data()), sizeof(Header)};
}

}  // namespace

UsbIpDevice::UsbIpDevice() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw std::runtime_error("no socket pair");
  const int attach = open("/sys/devices/platform/vhci_hcd.0/attach", O_WRONLY | O_CLOEXEC);
  if (attach < 0) throw std::runtime_error("no vhci_hcd: modprobe vhci-hcd, as root");
  constexpr int kPorts = 8, kBusAndDevice = 1 << 16 | 2, kHighSpeed = 3;
  bool done = false;
  for (int port = 0; port < kPorts && !done; ++port) {
    std::string line;
    for (const int word : {port, ends[1], kBusAndDevice, kHighSpeed}) line += std::to_string(word) + ' ';
    done = write(attach, line.data(), line.size()) > 0;
  }
  close(attach);
  close(ends[1]);
  if (!done) throw std::runtime_error("no free port in vhci_hcd");
  socket_ = ends[0];
}

void UsbIpDevice::detach() {
  if (socket_ < 0) return;
  shutdown(socket_, SHUT_RDWR);
  close(socket_);
  socket_ = -1;
}

bool UsbIpDevice::read_all(std::span<std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = read(socket_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

void UsbIpDevice::write_all(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && socket_ >= 0) {
    const ssize_t n = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return detach();
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

std::optional<UsbRequest> UsbIpDevice::receive(double timeout_seconds) {
  pollfd ready{socket_, POLLIN, 0};
  const auto nanoseconds = static_cast<long>(timeout_seconds * 1e9);
  const timespec timeout{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
  if (ppoll(&ready, 1, &timeout, nullptr) <= 0) return std::nullopt;
  Header header;
  UsbRequest request;
  bool whole = read_all(bytes_of(header));
  if (whole) {
    std::memcpy(request.setup.data(), &header[kSetup], 8);
    for (auto& word : header) word = ntohl(word);
    request.kind = header[kCommand] == kSubmit ? UsbRequest::Kind::kSubmit : UsbRequest::Kind::kUnlink;
    request.sequence = header[kSequence];
    request.unlinked = header[kFlagsOrStatus];
    request.endpoint = static_cast<int>(header[kEndpoint]);
    request.to_host = header[kDirection] == 1;
    request.length = header[kLength];
    if (request.kind == UsbRequest::Kind::kSubmit && !request.to_host) {
      request.data.resize(request.length);
      whole = read_all(request.data);
    }
  }
  if (!whole) {
    detach();
    return std::nullopt;
  }
  return request;
}

void UsbIpDevice::answer(const UsbRequest& request, int status, std::span<const std::uint8_t> data) {
  Header header{};
  header[kCommand] = kSubmitted;
  header[kSequence] = request.sequence;
  header[kFlagsOrStatus] = static_cast<std::uint32_t>(status);
  header[kLength] = static_cast<std::uint32_t>(request.to_host ? data.size() : status == 0 ? request.length : 0);
  for (auto& word : header) word = htonl(word);
  const auto head = bytes_of(header);
  std::vector<std::uint8_t> message(head.begin(), head.end());
  message.insert(message.end(), data.begin(), data.end());
  write_all(message);
}

void UsbIpDevice::answer_unlink(const UsbRequest& request, bool was_pending) {
  Header header{};
  header[kCommand] = kUnlinked;
  header[kSequence] = request.sequence;
  header[kFlagsOrStatus] = static_cast<std::uint32_t>(was_pending ? -ECONNRESET : 0);
  for (auto& word : header) word = htonl(word);
  write_all(bytes_of(header));
}

}  // namespace hdr::sim
