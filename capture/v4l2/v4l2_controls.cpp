#include "capture/v4l2/v4l2_controls.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <thread>

namespace hdr::v4l2 {
namespace {

int access_control(int descriptor, unsigned long request, std::uint32_t id, std::int64_t& value, int request_file) {
  v4l2_ext_control control{};
  control.id = id;
  control.value = static_cast<__s32>(value);
  v4l2_ext_controls list{};
  list.which = request_file >= 0 ? V4L2_CTRL_WHICH_REQUEST_VAL : V4L2_CTRL_WHICH_CUR_VAL;
  list.request_fd = request_file;
  list.count = 1;
  list.controls = &control;
  const int error = call(descriptor, request, &list);
  value = control.value;
  return error;
}

}  // namespace

int get_control(int descriptor, std::uint32_t id, std::int64_t& value, int request) {
  return access_control(descriptor, VIDIOC_G_EXT_CTRLS, id, value, request);
}

int set_control(int descriptor, std::uint32_t id, std::int64_t value, int request) {
  return access_control(descriptor, VIDIOC_S_EXT_CTRLS, id, value, request);
}

Controls::Controls(Device& device) : device_(device) {
  v4l2_query_ext_ctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  int error;
  while ((error = device_.ask(VIDIOC_QUERY_EXT_CTRL, query)) == 0) {
    if ((query.flags & V4L2_CTRL_FLAG_DISABLED) == 0) {
      controls_[query.id] = {query.id,
                             query.name,
                             query.minimum,
                             query.maximum,
                             static_cast<std::int64_t>(query.step),
                             (query.flags & V4L2_CTRL_FLAG_READ_ONLY) == 0};
    }
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  // EINVAL ends the list; a device without controls may not know the call at all.
  if (error != EINVAL && error != ENOTTY)
    throw error_of(error, During::kControl, device_.uri(), "listing its controls");
}

const Control* Controls::find(std::uint32_t id) const {
  const auto found = controls_.find(id);
  return found == controls_.end() ? nullptr : &found->second;
}

bool Controls::offers(std::uint32_t id, std::int64_t menu_item) const {
  const Control* control = find(id);
  if (!control || menu_item < control->min || menu_item > control->max) return false;
  v4l2_querymenu menu{};
  menu.id = id;
  menu.index = static_cast<__u32>(menu_item);
  return device_.ask(VIDIOC_QUERYMENU, menu) == 0;
}

std::int64_t Controls::get(std::uint32_t id) const {
  auto value = std::make_shared<std::int64_t>(0);
  const int error =
      device_.run([file = device_.file(), id, value] { return get_control(file->descriptor(), id, *value); });
  const Control* control = find(id);
  if (error)
    throw error_of(error, During::kControl, device_.uri(),
                   "reading " + (control ? control->name : fmt::format("{:x}", id)));
  return *value;
}

void Controls::set(std::uint32_t id, std::int64_t value) {
  constexpr std::chrono::milliseconds kPause{20};
  const auto deadline = std::chrono::steady_clock::now() + Device::kPatience;
  int error;
  do {
    error = device_.run([file = device_.file(), id, value] { return set_control(file->descriptor(), id, value); });
    if (error == EBUSY) std::this_thread::sleep_for(kPause);
  } while (error == EBUSY && std::chrono::steady_clock::now() < deadline);
  if (!error) return;
  const Control* control = find(id);
  throw error_of(error, During::kControl, device_.uri(),
                 fmt::format("setting {} to {}", control ? control->name : fmt::format("{:x}", id), value));
}

void Controls::hold(std::uint32_t id, std::int64_t value) {
  const bool first = [&] {
    const std::lock_guard lock(held_->mutex);
    return std::ranges::find(held_->values, id, &std::pair<std::uint32_t, std::int64_t>::first) == held_->values.end();
  }();
  if (first) {
    const std::int64_t old = get(id);
    const std::lock_guard lock(held_->mutex);
    held_->values.emplace_back(id, old);
  }
  set(id, value);
}

void Controls::give_back(int descriptor, Held& held) noexcept {
  const std::lock_guard lock(held.mutex);
  for (; !held.values.empty(); held.values.pop_back()) {
    const auto& [id, value] = held.values.back();
    const int error = set_control(descriptor, id, value);
    if (error && error_kind(error, During::kControl) == CameraError::Kind::kDisconnected) return held.values.clear();
  }
}

std::function<void()> Controls::restorer() const {
  return [file = device_.file(), held = held_] { give_back(file->descriptor(), *held); };
}

void Controls::restore() noexcept {
  try {
    device_.run([restore = restorer()] {
      restore();
      return 0;
    });
  } catch (...) {  // no memory for a call: nothing can be done for the device
  }
}

}  // namespace hdr::v4l2
