#include "capture/v4l2/v4l2_camera.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "capture/internal/order_of_calls.h"

namespace hdr {
namespace {

using Kind = CameraError::Kind;

/// V4L2_CID_EXPOSURE_ABSOLUTE counts in 100 us.
constexpr double kExposureUnit = 1e-4;

std::vector<Size> frame_sizes(v4l2::Device& device, std::uint32_t fourcc) {
  std::vector<Size> sizes;
  v4l2_frmsizeenum size{};
  size.pixel_format = fourcc;
  while (device.ask(VIDIOC_ENUM_FRAMESIZES, size) == 0) {
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
      sizes.push_back({static_cast<int>(size.stepwise.max_width), static_cast<int>(size.stepwise.max_height)});
      break;
    }
    sizes.push_back({static_cast<int>(size.discrete.width), static_cast<int>(size.discrete.height)});
    size.index += 1;
  }
  return sizes;
}

}  // namespace

std::vector<CameraName> list_v4l2_cameras() {
  std::map<int, std::string> nodes;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", none)) {
    const std::string name = entry.path().filename().string();
    int number = 0;
    if (name.starts_with("video") &&
        std::from_chars(name.data() + 5, name.data() + name.size(), number).ec == std::errc{}) {
      nodes[number] = entry.path().string();
    }
  }
  std::vector<CameraName> cameras;
  for (const auto& [number, path] : nodes) {
    const std::string uri = v4l2::kScheme + path;
    try {
      cameras.push_back({uri, v4l2::Device(uri, path).name()});
    } catch (const CameraError& error) {
      // A device without pictures is no camera; one that may not be asked could be.
      if (error.kind() != Kind::kNotSupported) cameras.push_back({uri, error.what()});
    }
  }
  return cameras;
}

std::unique_ptr<CameraDevice> open_v4l2_camera(const std::string& uri) {
  return std::make_unique<V4l2Camera>(uri, v4l2::parse_uri(uri));
}

V4l2Camera::V4l2Camera(const std::string& uri, const v4l2::Uri& wanted)
    : device_(uri, wanted.path), controls_(device_) {
  capabilities_.uri = uri;
  capabilities_.name = device_.name();
  capabilities_.formats = enumerate_formats(wanted);
  describe_exposure();
}

std::vector<FrameFormat> V4l2Camera::enumerate_formats(const v4l2::Uri& wanted) {
  std::vector<FrameFormat> formats;
  v4l2_fmtdesc description{};
  description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; device_.ask(VIDIOC_ENUM_FMT, description) == 0; description.index += 1) {
    const v4l2::FormatCode* code = v4l2::find_format(description.pixelformat);
    if (!code || (wanted.fourcc && *wanted.fourcc != code->fourcc)) continue;
    for (const Size size : frame_sizes(device_, code->fourcc)) {
      if (wanted.size && *wanted.size != size) continue;
      FrameFormat format = v4l2::frame_format(*code, size);
      if (is_bayer(format.pixels)) format.black_level = wanted.black_level;
      formats.push_back(format);
    }
  }
  std::ranges::stable_sort(formats, v4l2::better_for_brackets);
  return formats;
}

void V4l2Camera::describe_exposure() {
  const v4l2::Control* exposure = controls_.find(V4L2_CID_EXPOSURE_ABSOLUTE);
  // Shutter priority is as good: the time is ours, and these cameras have no iris.
  for (const int mode : {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY}) {
    if (!manual_mode_ && controls_.offers(V4L2_CID_EXPOSURE_AUTO, mode)) manual_mode_ = mode;
  }
  const bool mode_is_fixed = controls_.find(V4L2_CID_EXPOSURE_AUTO) == nullptr;
  capabilities_.manual_exposure = exposure && exposure->writable && (manual_mode_ || mode_is_fixed);
  if (exposure) {
    // A time of 0 is no exposure.
    const auto least = std::max<std::int64_t>(exposure->min, 1);
    capabilities_.seconds = {static_cast<double>(least) * kExposureUnit,
                             static_cast<double>(exposure->max) * kExposureUnit,
                             static_cast<double>(exposure->step) * kExposureUnit};
  }
  for (const std::uint32_t id : {V4L2_CID_ANALOGUE_GAIN, V4L2_CID_GAIN}) {
    const v4l2::Control* gain = controls_.find(id);
    // Values from 0 have a unit that nobody tells; values from, say, 16 are mostly sixteenths.
    if (!gain || !gain->writable || gain->min <= 0) continue;
    const auto unit = static_cast<double>(gain->min);
    capabilities_.gain = {1, static_cast<double>(gain->max) / unit, static_cast<double>(gain->step) / unit};
    gain_control_ = id;
    break;
  }
  const v4l2::Control* dynamic_rate = controls_.find(V4L2_CID_EXPOSURE_AUTO_PRIORITY);
  rate_follows_exposure_ = dynamic_rate && dynamic_rate->writable;
  if (capabilities_.formats.empty()) return;
  const FrameFormat& best = capabilities_.formats.front();
  capabilities_.frame_seconds =
      v4l2::frame_intervals(device_, v4l2::find_format(best.pixels, best.cfa)->fourcc, best.size).shortest;
}

FrameFormat V4l2Camera::configure(const Configuration& configuration) {
  internal::require_configurable(capabilities_.uri, stream_.has_value());
  for (const FrameFormat& format : capabilities_.formats) {
    if (configuration.pixels && format.pixels != *configuration.pixels) continue;
    if (configuration.size && format.size != *configuration.size) continue;
    const v4l2::FormatCode& code = *v4l2::find_format(format.pixels, format.cfa);
    format_ = v4l2::set_format(device_, code, format.size);
    format_->black_level = format.black_level;
    dmabuf_ = configuration.dmabuf;
    const double shortest = v4l2::frame_intervals(device_, code.fourcc, format.size).shortest;
    if (shortest > 0) capabilities_.frame_seconds = shortest;
    return *format_;
  }
  throw CameraError(Kind::kNotSupported,
                    capabilities_.uri + ": the camera has no such format that we know; hdr cameras lists those it has");
}

v4l2::ControlValues V4l2Camera::control_values(const ExposureSetting& setting) const {
  v4l2::ControlValues values;
  if (gain_control_ != 0) {
    const double gain = capabilities_.gain.snap(setting.gain);
    values[gain_control_] = std::llround(gain * static_cast<double>(controls_.find(gain_control_)->min));
  }
  values[V4L2_CID_EXPOSURE_ABSOLUTE] = std::llround(capabilities_.seconds.snap(setting.seconds) / kExposureUnit);
  return values;
}

std::optional<ExposureSetting> V4l2Camera::reported(const v4l2::ControlValues& values) const {
  const auto seconds = values.find(V4L2_CID_EXPOSURE_ABSOLUTE);
  if (seconds == values.end()) return std::nullopt;
  ExposureSetting setting{static_cast<double>(seconds->second) * kExposureUnit, 1};
  const auto gain = values.find(gain_control_);
  if (gain != values.end()) {
    setting.gain = static_cast<double>(gain->second) / static_cast<double>(controls_.find(gain_control_)->min);
  }
  return setting;
}

void V4l2Camera::hold_automatics() {
  if (manual_mode_) controls_.hold(V4L2_CID_EXPOSURE_AUTO, *manual_mode_);
  // Modes first: a value that its mode controls is refused. Then what the modes left is kept as it is.
  for (const std::uint32_t id : {V4L2_CID_AUTOGAIN, V4L2_CID_AUTO_WHITE_BALANCE, V4L2_CID_FOCUS_AUTO}) {
    const v4l2::Control* control = controls_.find(id);
    if (control && control->writable) controls_.hold(id, 0);
  }
  // On: a long exposure makes frames slow. Off: it is cut to the frame's duration, in silence.
  if (rate_follows_exposure_) controls_.hold(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 1);
  const v4l2::Control* white_balance = controls_.find(V4L2_CID_WHITE_BALANCE_TEMPERATURE);
  if (white_balance && white_balance->writable) controls_.hold(white_balance->id, controls_.get(white_balance->id));
}

void V4l2Camera::start_stream() {
  const double wanted = rate_follows_exposure_ ? 0 : setting_.seconds;
  interval_seconds_ = v4l2::set_frame_interval(device_, std::max(wanted, capabilities_.frame_seconds));
  stream_.emplace(device_, *format_,
                  v4l2::StreamOptions{.dmabuf = dmabuf_, .request_controls = control_values(setting_)});
  capabilities_.reports_exposure = stream_->has_requests();
}

void V4l2Camera::start(const ExposureSetting& first) {
  internal::require_startable(capabilities_, stream_.has_value());
  if (!format_) configure({});
  try {
    restore_on_signal_.emplace(controls_.restorer());
    hold_automatics();
    setting_ = first;
    for (const auto& [id, value] : control_values(first)) controls_.hold(id, value);
    start_stream();
  } catch (...) {
    stop();
    throw;
  }
}

void V4l2Camera::set(const ExposureSetting& setting) {
  internal::require_running(capabilities_.uri, stream_.has_value());
  setting_ = setting;
  if (stream_->has_requests()) {
    stream_->ask(control_values(setting));
  } else {
    for (const auto& [id, value] : control_values(setting)) controls_.set(id, value);
  }
  // The frame rate cannot change while the device streams.
  if (!rate_follows_exposure_ && interval_seconds_ > 0 && setting.seconds > interval_seconds_) {
    stream_.reset();
    start_stream();
  }
}

Frame V4l2Camera::next_frame(std::chrono::steady_clock::time_point deadline) {
  internal::require_running(capabilities_.uri, stream_.has_value());
  v4l2::Arrived arrived = stream_->next(deadline);
  arrived.frame.requested = setting_;
  arrived.frame.reported = reported(arrived.controls);
  return std::move(arrived.frame);
}

void V4l2Camera::stop() {
  stream_.reset();
  controls_.restore();
  restore_on_signal_.reset();
}

}  // namespace hdr
