#include "capture/libcamera/libcamera_controls.h"

#include <libcamera/version.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

// Since 0.5 the exposure time and the gain have modes of their own; AeEnable is a shorthand for both.
#if LIBCAMERA_VERSION_MAJOR > 0 || LIBCAMERA_VERSION_MINOR >= 5
#define HDR_LIBCAMERA_HAS_MODES 1
#else
#define HDR_LIBCAMERA_HAS_MODES 0
#endif

namespace hdr::lc {
namespace {

namespace controls = libcamera::controls;
using libcamera::Span;

constexpr double kMicrosecond = 1e-6;
/// USB cameras count in these [UVC 1.1, 4.2.2.1.4], and libcamera cuts off what is between.
constexpr double kUsbStep = 1e-4;

const libcamera::ControlInfo* find(const libcamera::Camera& camera, const libcamera::ControlId& id) {
  const auto& all = camera.controls();
  const auto found = all.find(id.id());
  return found == all.end() ? nullptr : &found->second;
}

/// Pipelines that drive a sensor themselves know the duration of its frames. Those of USB cameras do not, and their
/// gain is a made-up scale from 1.
bool drives_the_sensor(const libcamera::Camera& camera) {
  return find(camera, controls::FrameDurationLimits) != nullptr;
}

}  // namespace

void describe_exposure(const libcamera::Camera& camera, Capabilities& capabilities) {
  const libcamera::ControlInfo* seconds = find(camera, controls::ExposureTime);
  capabilities.manual_exposure = seconds != nullptr;
  if (seconds) {
    const auto least = std::max(1, seconds->min().get<std::int32_t>());
    capabilities.seconds = {least * kMicrosecond, seconds->max().get<std::int32_t>() * kMicrosecond, 0};
    if (!drives_the_sensor(camera)) {
      capabilities.seconds.step = kUsbStep;
      capabilities.seconds.min = kUsbStep * std::max(1.0, std::ceil(capabilities.seconds.min / kUsbStep - 1e-6));
    }
  }
  capabilities.reports_exposure = drives_the_sensor(camera);
  if (!drives_the_sensor(camera)) return;
  if (const libcamera::ControlInfo* gain = find(camera, controls::AnalogueGain)) {
    // Gains below 1 would be less than all of the signal.
    const double least = std::max(1.0f, gain->min().get<float>());
    capabilities.gain = {least, std::max<double>(least, gain->max().get<float>()), 0};
  }
  const auto shortest = find(camera, controls::FrameDurationLimits)->min();
  if (shortest.type() == libcamera::ControlTypeInteger64 && !shortest.isArray()) {
    capabilities.frame_seconds = static_cast<double>(shortest.get<std::int64_t>()) * kMicrosecond;
  }
}

libcamera::ControlList manual(const libcamera::Camera& camera, const Capabilities& capabilities,
                              const ExposureSetting& setting) {
  libcamera::ControlList list(camera.controls());
  if (find(camera, controls::AeEnable)) list.set(controls::AeEnable, false);
#if HDR_LIBCAMERA_HAS_MODES
  if (find(camera, controls::ExposureTimeMode)) list.set(controls::ExposureTimeMode, controls::ExposureTimeModeManual);
  if (find(camera, controls::AnalogueGainMode)) list.set(controls::AnalogueGainMode, controls::AnalogueGainModeManual);
#endif
  if (find(camera, controls::AwbEnable)) list.set(controls::AwbEnable, false);
  if (find(camera, controls::AfMode)) list.set(controls::AfMode, controls::AfModeManual);
  const auto microseconds =
      static_cast<std::int32_t>(std::lround(capabilities.seconds.snap(setting.seconds) / kMicrosecond));
  list.set(controls::ExposureTime, microseconds);
  if (!drives_the_sensor(camera)) return list;
  if (find(camera, controls::AnalogueGain)) {
    list.set(controls::AnalogueGain, static_cast<float>(capabilities.gain.snap(setting.gain)));
  }
  // A frame that is shorter than its exposure would cut it.
  const std::int64_t shortest = std::llround(capabilities.frame_seconds / kMicrosecond);
  const std::int64_t duration = std::max<std::int64_t>(shortest, microseconds);
  const std::array<std::int64_t, 2> limits = {duration, duration + duration / 10};
  list.set(controls::FrameDurationLimits, Span<const std::int64_t, 2>(limits));
  return list;
}

libcamera::ControlList automatic(const libcamera::Camera& camera) {
  libcamera::ControlList list(camera.controls());
  if (find(camera, controls::AeEnable)) list.set(controls::AeEnable, true);
#if HDR_LIBCAMERA_HAS_MODES
  if (find(camera, controls::ExposureTimeMode)) list.set(controls::ExposureTimeMode, controls::ExposureTimeModeAuto);
  if (find(camera, controls::AnalogueGainMode)) list.set(controls::AnalogueGainMode, controls::AnalogueGainModeAuto);
#endif
  if (find(camera, controls::AwbEnable)) list.set(controls::AwbEnable, true);
  return list;
}

std::optional<ExposureSetting> reported(const libcamera::ControlList& metadata) {
  const auto microseconds = metadata.get(controls::ExposureTime);
  if (!microseconds) return std::nullopt;
  const auto gain = metadata.get(controls::AnalogueGain);
  return ExposureSetting{*microseconds * kMicrosecond, gain ? static_cast<double>(*gain) : 1.0};
}

std::optional<double> black_level(const libcamera::ControlList& metadata, int bits) {
  const auto levels = metadata.get(controls::SensorBlackLevels);
  if (!levels) return std::nullopt;
  // They are for 16 bits, one for each colour of the filter; sensors have one.
  double sum = 0;
  for (const std::int32_t level : *levels) sum += level;
  return sum / static_cast<double>(levels->size()) / std::exp2(16 - bits);
}

}  // namespace hdr::lc
