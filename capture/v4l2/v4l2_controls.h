#pragma once
// A device's controls: what there is, and values that are held for a while and then given back.
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "capture/v4l2/v4l2_device.h"

namespace hdr::v4l2 {

struct Control {
  std::uint32_t id = 0;
  std::string name;
  std::int64_t min = 0, max = 0, step = 1;
  bool writable = false;
};

class Controls {
 public:
  /// `device` must outlive it.
  explicit Controls(Device& device);

  /// nullptr when the device has no such control.
  const Control* find(std::uint32_t id) const;
  bool offers(std::uint32_t id, std::int64_t menu_item) const;

  /// Each in a call of its own: a device that refuses one of several leaves the others undefined. Throws CameraError:
  /// kBusy when the device says for kPatience that it is not ready, kTimeout when it says nothing.
  std::int64_t get(std::uint32_t id) const;
  void set(std::uint32_t id, std::int64_t value);
  /// Sets it, and remembers what it was when it is held for the first time.
  void hold(std::uint32_t id, std::int64_t value);
  /// Gives back what is held, the last one first: values before the automatic modes that would refuse them. Never
  /// throws: a device that is gone needs no settings.
  void restore() noexcept;
  /// A call that does the same from another thread and owns what it needs.
  std::function<void()> restorer() const;

 private:
  struct Held {
    std::mutex mutex;
    std::vector<std::pair<std::uint32_t, std::int64_t>> values;
  };
  static void give_back(int descriptor, Held& held) noexcept;

  Device& device_;
  std::map<std::uint32_t, Control> controls_;
  std::shared_ptr<Held> held_ = std::make_shared<Held>();
};

/// One control of `descriptor`, of the request when `request` is one (>= 0). 0 or an errno.
int get_control(int descriptor, std::uint32_t id, std::int64_t& value, int request = -1);
int set_control(int descriptor, std::uint32_t id, std::int64_t value, int request = -1);

}  // namespace hdr::v4l2
