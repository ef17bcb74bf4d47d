#include "capture/virtual/virtual_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

#include "capture/internal/order_of_calls.h"
#include "capture/virtual/encode.h"
#include "libhdr/core/random.h"

namespace hdr {
namespace {

using Kind = CameraError::Kind;
using Clock = std::chrono::steady_clock;

Clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

double seconds_of(Clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

double median_of(View<const float> scene) {
  std::vector<float> samples;
  samples.reserve(static_cast<std::size_t>(scene.width()) * static_cast<std::size_t>(scene.height()) * 3);
  for (int y = 0; y < scene.height(); ++y) {
    const float* row = scene.row(y);
    samples.insert(samples.end(), row, row + static_cast<std::ptrdiff_t>(scene.width()) * scene.channels());
  }
  if (samples.empty()) throw Error("virtual camera: the scene has no pixels");
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (*middle > 0) return *middle;
  // More than half of the scene is black: meter on its brightest sample; all black: any sensitivity photographs it.
  const double brightest = *std::max_element(samples.begin(), samples.end());
  return brightest > 0 ? brightest : 1;
}

/// Mean of 1 + depth sin(2 pi hz t) over an exposure.
double mean_flicker(double hz, double depth, double start, double seconds) {
  if (!(hz > 0)) return 1;
  const double omega = 2 * std::numbers::pi * hz;
  return 1 + depth * (std::cos(omega * start) - std::cos(omega * (start + seconds))) / (omega * seconds);
}

}  // namespace

double metered_sensitivity(View<const float> scene, const Exposure& exposure, double level) {
  return level / (median_of(scene) * exposure.relative().value());
}

VirtualCamera::VirtualCamera(std::string uri, Image<float> scene, VirtualCameraOptions options)
    : uri_(std::move(uri)), scene_(std::move(scene)), options_(std::move(options)), median_(median_of(scene_)) {
  HDR_ASSERT(options_.latency >= 0 && !options_.formats.empty() && options_.frame_seconds > 0);
  HDR_ASSERT(response_from_name(options_.response, 8).has_value());
  if (!(options_.sensitivity > 0)) {
    Exposure metered = options_.optics;
    metered.seconds = 1.0 / 60;
    options_.sensitivity = options_.level / (median_ * metered.relative().value());
  }
  format_ = format_of(options_.formats.front());
}

FrameFormat VirtualCamera::format_of(PixelFormat pixels) const {
  FrameFormat format;
  format.pixels = pixels;
  format.cfa = is_bayer(pixels) ? options_.cfa : Cfa::kNone;
  format.size = scene_.size();
  format.stride_bytes = row_bytes_of(pixels, format.size.width);
  format.white_level = std::ldexp(1.0, bits_of(pixels)) - 1;
  // Sensors add a pedestal, so that noise does not end at zero.
  if (is_bayer(pixels)) format.black_level = std::ldexp(1.0, bits_of(pixels) - 6);
  return format;
}

Capabilities VirtualCamera::capabilities() const {
  Capabilities capabilities;
  capabilities.uri = uri_;
  capabilities.name = "virtual camera";
  for (const PixelFormat pixels : options_.formats) capabilities.formats.push_back(format_of(pixels));
  capabilities.manual_exposure = !options_.faults.no_manual;
  capabilities.seconds = options_.seconds;
  capabilities.gain = options_.gain;
  capabilities.frame_seconds = options_.frame_seconds;
  capabilities.f_number = options_.optics.f_number;
  capabilities.iso = options_.optics.iso;
  capabilities.reports_exposure = options_.metadata;
  return capabilities;
}

FrameFormat VirtualCamera::configure(const Configuration& configuration) {
  internal::require_configurable(uri_, running_);
  if (options_.faults.permission) {
    throw CameraError(Kind::kPermission, uri_ + ": may not be opened; ask for the right to use it");
  }
  if (configuration.dmabuf) throw CameraError(Kind::kNotSupported, uri_ + ": has no DMABUF; leave it out");
  const PixelFormat pixels = configuration.pixels.value_or(options_.formats.front());
  if (std::find(options_.formats.begin(), options_.formats.end(), pixels) == options_.formats.end() ||
      (configuration.size && *configuration.size != scene_.size())) {
    std::string offered;
    for (const FrameFormat& format : capabilities().formats) offered += (offered.empty() ? "" : ", ") + to_text(format);
    throw CameraError(Kind::kNotSupported, fmt::format("{}: has no such format; it has {}", uri_, offered));
  }
  format_ = format_of(pixels);
  return format_;
}

/// What the device makes of a setting, whether it says so or not.
ExposureSetting VirtualCamera::device_setting(const ExposureSetting& asked) const {
  return {std::min(options_.seconds.snap(asked.seconds), options_.faults.clamp_seconds),
          options_.gain.snap(asked.gain)};
}

void VirtualCamera::start(const ExposureSetting& first) {
  if (options_.faults.permission) {
    throw CameraError(Kind::kPermission, uri_ + ": may not be opened; ask for the right to use it");
  }
  if (options_.faults.busy) throw CameraError(Kind::kBusy, uri_ + ": another program has it; close that one");
  internal::require_startable(capabilities(), running_);
  running_ = true;
  sequence_ = 0;
  sets_ = 0;
  requested_ = first;
  device_ = automatic_ = device_setting(first);
  pending_.assign(static_cast<std::size_t>(options_.latency), device_);
  exposing_since_ = now_;
  real_start_ = Clock::now() - (now_ - Clock::time_point{});
}

void VirtualCamera::set(const ExposureSetting& setting) {
  internal::require_running(uri_, running_);
  if (!(setting.seconds > 0) || !std::isfinite(setting.seconds) || !(setting.gain > 0) ||
      !std::isfinite(setting.gain)) {
    throw CameraError(Kind::kNotSupported,
                      fmt::format("{}: cannot expose for {} s at gain {}; ask for positive numbers", uri_,
                                  setting.seconds, setting.gain));
  }
  const int call = sets_++;
  if (call == options_.faults.stall) {
    throw CameraError(Kind::kTimeout, uri_ + ": the exposure control does not answer; unplug it and plug it in again");
  }
  requested_ = setting;
  if (call < options_.faults.stuck) device_ = device_setting(setting);
}

bool VirtualCamera::strikes(double share, std::uint64_t fault) const {
  return share > 0 && Random(options_.seed, 0xfa017 + fault, sequence_).uniform() < share;
}

/// An automatic exposure that goes half of the way, in log, to where the median is at its level.
void VirtualCamera::meter(const ExposureSetting& exposure) {
  Exposure optics = options_.optics;
  optics.seconds = exposure.seconds;
  const double level = median_ * options_.sensitivity * optics.relative().value();
  automatic_ = device_setting({exposure.seconds * std::sqrt(options_.level / level), 1});
}

std::vector<std::uint8_t> VirtualCamera::photograph(const ExposureSetting& exposure, double start_seconds) const {
  Exposure optics = options_.optics;
  optics.seconds = exposure.seconds;
  const double light = mean_flicker(options_.flicker_hz, options_.flicker_depth, start_seconds, exposure.seconds);
  VirtualSensor sensor{options_.response, options_.noise};
  // Gain fills the code range with fewer electrons.
  sensor.noise.full_well /= exposure.gain;
  return encode(scene_, options_.sensitivity * optics.relative().value() * exposure.gain * light, sensor, format_,
                hash64(options_.seed) + sequence_);
}

Frame VirtualCamera::next_frame(Clock::time_point deadline) {
  internal::require_running(uri_, running_);
  const auto late = [&] { return CameraError(Kind::kTimeout, uri_ + ": no frame before the deadline"); };
  if (now_ > deadline) throw late();
  for (;; ++sequence_) {
    if (sequence_ >= static_cast<std::uint32_t>(options_.faults.unplug)) {
      throw CameraError(Kind::kDisconnected, uri_ + ": the camera is gone; plug it in again");
    }
    pending_.push_back(device_);
    const ExposureSetting exposure = options_.faults.automatic ? automatic_ : pending_.front();
    const Clock::time_point start = exposing_since_;
    const Clock::time_point end = start + duration_of(std::max(exposure.seconds, options_.frame_seconds));
    if (end > deadline || sequence_ >= static_cast<std::uint32_t>(options_.faults.freeze)) {
      pending_.pop_back();  // the frame is still being exposed: the next call may wait for it
      now_ = deadline;
      throw late();
    }
    pending_.pop_front();
    if (options_.faults.automatic) meter(exposure);
    now_ = exposing_since_ = end;
    if (options_.realtime) std::this_thread::sleep_until(real_start_ + (end - Clock::time_point{}));
    if (strikes(options_.faults.dropped, 0) || strikes(options_.faults.damaged, 1)) continue;

    auto bytes =
        std::make_shared<std::vector<std::uint8_t>>(photograph(exposure, seconds_of(start - Clock::time_point{})));
    if (options_.faults.torn > 0) {
      const std::vector<std::uint8_t> whole = *bytes;
      if (strikes(options_.faults.torn, 2) && before_.size() == whole.size()) {
        const auto half = static_cast<std::ptrdiff_t>(whole.size() / 2);
        std::copy(before_.begin() + half, before_.end(), bytes->begin() + half);
      }
      before_ = whole;
    }
    if (strikes(options_.faults.cut, 3)) bytes->resize(bytes->size() / 2);
    last_exposure_ = exposure;
    Frame frame;
    frame.bytes = *bytes;
    frame.owner = bytes;
    frame.format = format_;
    frame.sequence = sequence_++;
    frame.timestamp = start.time_since_epoch();
    frame.requested = requested_;
    if (options_.metadata) frame.reported = exposure;
    return frame;
  }
}

void VirtualCamera::stop() {
  running_ = false;
}

}  // namespace hdr
