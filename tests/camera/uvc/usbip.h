#pragma once
// The kernel's USB/IP host controller (vhci-hcd) as seen by a device in user space.
// Protocol: Documentation/usb/usbip_protocol.rst.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hdr::sim {

struct UsbRequest {
  enum class Kind { kSubmit, kUnlink } kind = Kind::kSubmit;
  std::uint32_t sequence = 0;
  std::uint32_t unlinked = 0;  ///< the request that the host no longer wants
  int endpoint = 0;
  bool to_host = false;
  std::uint32_t length = 0;
  std::array<std::uint8_t, 8> setup{};
  std::vector<std::uint8_t> data;  ///< from the host
};

/// A high-speed device, attached while it lives. Needs root and the module vhci-hcd.
class UsbIpDevice {
 public:
  UsbIpDevice();
  ~UsbIpDevice() { detach(); }
  UsbIpDevice(const UsbIpDevice&) = delete;

  bool attached() const { return socket_ >= 0; }
  /// The cable is pulled.
  void detach();
  /// The next request, or nothing within the time. Detaches when the kernel has let go.
  std::optional<UsbRequest> receive(double timeout_seconds);
  /// status: 0 or -errno; -EPIPE is a stall.
  void answer(const UsbRequest& request, int status, std::span<const std::uint8_t> data = {});
  void answer_unlink(const UsbRequest& request, bool was_pending);

 private:
  bool read_all(std::span<std::uint8_t> bytes);
  void write_all(std::span<const std::uint8_t> bytes);

  int socket_ = -1;
};

}  // namespace hdr::sim
