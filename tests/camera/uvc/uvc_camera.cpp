#include "tests/camera/uvc/uvc_camera.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>

namespace hdr::sim {
namespace {

double now_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// [UVC 1.1] table A-8: class requests; 4-10: what a stall meant.
enum Request : std::uint8_t {
  kSetCur = 0x01,
  kGetCur = 0x81,
  kGetMin = 0x82,
  kGetMax = 0x83,
  kGetRes = 0x84,
  kGetLen = 0x85,
  kGetInfo = 0x86,
  kGetDef = 0x87
};
enum RequestError : std::uint8_t { kNotReady = 1, kWrongState = 2, kOutOfRange = 4, kInvalidControl = 6 };
enum CameraSelector { kAutoExposureMode = 2, kAutoExposurePriority = 3, kExposureTime = 4 };
enum ProcessingSelector { kBrightness = 2, kGain = 4, kWhiteBalance = 0x0A, kWhiteBalanceAuto = 0x0B };
constexpr std::uint32_t kManualMode = 1, kAperturePriorityMode = 8;

/// Video probe and commit controls, [UVC 1.1] table 4-75.
constexpr int kProbeBytes = 34;
constexpr std::uint32_t kPayloadHeaderBytes = 12;

std::uint32_t little_endian(const Bytes& bytes) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < std::min<std::size_t>(4, bytes.size()); ++k)
    value |= static_cast<std::uint32_t>(bytes[k]) << (8 * k);
  return value;
}

Bytes le(std::uint32_t value, int count) {
  Bytes bytes;
  append_le(bytes, value, count);
  return bytes;
}

/// A control of a unit as UVC describes it.
struct UnitControl {
  std::uint32_t min, max, resolution, initial;
  int bytes;
  std::uint8_t info;
  std::uint32_t current;
};
constexpr std::uint8_t kGetAndSet = 3, kDisabledByAuto = 4, kAutoUpdate = 8;

}  // namespace

UvcCamera::UvcCamera(const SensorOptions& sensor, const Faults& faults, const std::string& log)
    : sensor_(sensor), faults_(faults) {
  if (!log.empty()) log_.open(log);
}

bool UvcCamera::serve(double seconds) {
  double wait = seconds;
  if (streaming_ && !payload_.empty()) wait = 0;
  if (streaming_ && payload_.empty() && !frozen()) wait = std::clamp(next_frame_at_ - now_seconds(), 0.0, seconds);
  if (const auto request = usb_.receive(wait)) handle(*request);
  stream(now_seconds());
  return usb_.attached();
}

void UvcCamera::handle(const UsbRequest& request) {
  if (request.kind == UsbRequest::Kind::kUnlink) {
    const auto same = [&](const UsbRequest& r) { return r.sequence == request.unlinked; };
    const std::size_t dropped = std::erase_if(waiting_, same) + std::erase_if(unanswered_, same);
    usb_.answer_unlink(request, dropped > 0);
    return;
  }
  if (request.endpoint != 0) {
    waiting_.push_back(request);
    return;
  }
  Answer answer = control(request);
  if (answer.silent) {
    unanswered_.push_back(request);
    return;
  }
  if (answer.data.size() > request.length) answer.data.resize(request.length);
  usb_.answer(request, answer.status, answer.data);
}

UvcCamera::Answer UvcCamera::control(const UsbRequest& request) {
  constexpr int kTypeMask = 0x60, kStandard = 0, kClass = 0x20, kStreamingInterface = 1;
  const int type = request.setup[0] & kTypeMask;
  if (type == kStandard) return standard_request(request);
  if (type != kClass) return {-EPIPE};
  return request.setup[4] == kStreamingInterface ? streaming_request(request) : unit_request(request);
}

UvcCamera::Answer UvcCamera::standard_request(const UsbRequest& request) {
  enum { kGetStatus = 0, kClearFeature = 1, kGetDescriptor = 6, kGetConfiguration = 8, kGetInterface = 10 };
  switch (request.setup[1]) {
    case kGetDescriptor:
      switch (request.setup[3]) {
        case 1:
          return {0, device_descriptor()};
        case 2:
          return {0, configuration_descriptor(!faults_.no_manual_exposure)};
        case 3:
          return {0, string_descriptor(request.setup[2])};
        case 6:
          return {0, device_qualifier()};
        default:
          return {-EPIPE};
      }
    case kGetStatus:
      return {0, {0, 0}};
    case kGetConfiguration:
      return {0, {1}};
    case kGetInterface:
      return {0, {0}};
    case kClearFeature:
      stop_streaming();
      return {};  // how a host ends a bulk stream: it clears the endpoint's halt
    default:
      return {};  // addresses, configurations and interfaces: as the host likes
  }
}

UvcCamera::Answer UvcCamera::streaming_request(const UsbRequest& request) {
  enum { kProbe = 1, kCommit = 2 };
  const int selector = request.setup[3];
  if (selector != kProbe && selector != kCommit) return {-EPIPE};
  switch (request.setup[1]) {
    case kSetCur: {
      if (request.data.size() < 8) return {-EPIPE};
      format_ = static_cast<std::uint8_t>(std::clamp<int>(request.data[2], 1, kEncodings.size()));
      frame_ = static_cast<std::uint8_t>(std::clamp<int>(request.data[3], 1, kSizes.size()));
      const std::int64_t asked = little_endian({request.data.begin() + 4, request.data.begin() + 8});
      interval_ = *std::ranges::min_element(kIntervals, {}, [&](std::int64_t i) { return std::llabs(i - asked); });
      if (selector == kCommit) {
        stop_streaming();
        streaming_ = true;
        constexpr double kFirstFrameAfter = 0.05;
        next_frame_at_ = now_seconds() + kFirstFrameAfter;
        stream_number_ += 1;
        frame_number_ = 0;
        sensor_.restart();
      }
      return {};
    }
    case kGetLen:
      return {0, {kProbeBytes, 0}};
    case kGetInfo:
      return {0, {kGetAndSet}};
    case kGetCur:
    case kGetMin:
    case kGetMax:
    case kGetDef:
      break;
    default:
      return {-EPIPE};
  }
  const FrameSize size = kSizes[frame_ - 1];
  const auto picture = static_cast<std::uint32_t>(picture_bytes(kEncodings[format_ - 1], size.width, size.height));
  Bytes probe{1, 0, format_, frame_};
  append_le(probe, interval_, 4);
  probe.resize(18);  // key frames, P frames, quality, window and delay: nothing to say
  append_le(probe, picture, 4);
  append_le(probe, picture + kPayloadHeaderBytes, 4);  // one payload a frame
  append_le(probe, 1'000'000, 4);
  probe.insert(probe.end(), {3, 1, 1, 1});
  return {0, probe};
}

UvcCamera::Answer UvcCamera::unit_request(const UsbRequest& request) {
  const int entity = request.setup[5], selector = request.setup[3], kind = request.setup[1];
  constexpr int kErrorCode = 2;
  if (entity == 0 && selector == kErrorCode) return {0, {kind == kGetInfo ? std::uint8_t{1} : last_error_}};
  const Settings& s = sensor_.settings;
  UnitControl control;
  const auto exposure_info =
      static_cast<std::uint8_t>(kGetAndSet | kAutoUpdate | (s.auto_exposure ? kDisabledByAuto : 0));
  const int key = entity << 8 | selector;
  switch (key) {
    case kCameraTerminal << 8 | kAutoExposureMode:
      control = {1,
                 kAperturePriorityMode,
                 kManualMode | kAperturePriorityMode,
                 kAperturePriorityMode,
                 1,
                 kGetAndSet,
                 s.auto_exposure ? kAperturePriorityMode : kManualMode};
      break;
    case kCameraTerminal << 8 | kAutoExposurePriority:
      control = {0, 1, 1, 0, 1, kGetAndSet, s.dynamic_frame_rate};
      break;
    case kCameraTerminal << 8 | kExposureTime:
      control = {sensor_.options().min_exposure_100us,
                 sensor_.options().max_exposure_100us,
                 1,
                 156,
                 4,
                 exposure_info,
                 s.exposure_100us};
      break;
    case kProcessingUnit << 8 | kBrightness:
      control = {0, 255, 1, 128, 2, kGetAndSet, s.brightness};
      break;
    case kProcessingUnit << 8 | kGain:
      control = {16, 255, 1, 16, 2, kGetAndSet, s.gain_16ths};
      break;
    case kProcessingUnit << 8 | kWhiteBalanceAuto:
      control = {0, 1, 1, 1, 1, kGetAndSet, s.auto_white_balance};
      break;
    case kProcessingUnit << 8 | kWhiteBalance:
      control = {2800, 6500, 10, 4600, 2, kGetAndSet, s.white_balance_kelvin};
      break;
    default:
      last_error_ = kInvalidControl;
      return {-EPIPE};
  }
  switch (kind) {
    case kGetCur:
      return {0, le(control.current, control.bytes)};
    case kGetMin:
      return {0, le(control.min, control.bytes)};
    case kGetMax:
      return {0, le(control.max, control.bytes)};
    case kGetRes:
      return {0, le(control.resolution, control.bytes)};
    case kGetDef:
      return {0, le(control.initial, control.bytes)};
    case kGetLen:
      return {0, {static_cast<std::uint8_t>(control.bytes), 0}};
    case kGetInfo:
      return {0, {control.info}};
    case kSetCur:
      break;
    default:
      return {-EPIPE};
  }
  const std::uint32_t value = little_endian(request.data);
  const bool is_mode = key == (kCameraTerminal << 8 | kAutoExposureMode);
  if (is_mode ? (value & control.resolution) == 0 : value < control.min || value > control.max) {
    last_error_ = kOutOfRange;
    return {-EPIPE};
  }
  return set_unit(entity, selector, request.data);
}

UvcCamera::Answer UvcCamera::set_unit(int entity, int selector, const Bytes& data) {
  const std::uint32_t value = little_endian(data);
  Settings& s = sensor_.settings;
  if (entity == kCameraTerminal) {
    switch (selector) {
      case kAutoExposureMode:
        s.auto_exposure = value == kAperturePriorityMode;
        break;
      case kAutoExposurePriority:
        s.dynamic_frame_rate = value != 0;
        break;
      case kExposureTime:
        if (faults_.exposure_silent) return {.silent = true};
        if (faults_.exposure_refused || s.auto_exposure) {
          last_error_ = faults_.exposure_refused ? kNotReady : kWrongState;
          return {-EPIPE};
        }
        s.exposure_100us = value;
        break;
    }
  } else {
    const auto word = static_cast<std::uint16_t>(value);
    switch (selector) {
      case kBrightness:
        s.brightness = word;
        break;
      case kGain:
        s.gain_16ths = word;
        break;
      case kWhiteBalanceAuto:
        s.auto_white_balance = value != 0;
        break;
      case kWhiteBalance:
        s.white_balance_kelvin = word;
        break;
    }
  }
  return {};
}

void UvcCamera::stop_streaming() {
  streaming_ = false;
  payload_.clear();
  sent_ = 0;
}

void UvcCamera::stream(double now) {
  if (!streaming_ || waiting_.empty()) return;
  if (payload_.empty()) {
    if (now < next_frame_at_ || frozen()) return;
    take_frame(now);
  }
  send_frame();
}

void UvcCamera::take_frame(double now) {
  if (frame_number_ == faults_.unplug_at_frame) return unplug();
  const double interval = interval_ * 1e-7;
  const Settings used = sensor_.expose(interval);
  const double duration = std::max(interval, used.exposure_100us * 1e-4);
  next_frame_at_ = std::max(next_frame_at_ + duration, now + interval / 4);
  if (log_)
    log_ << stream_number_ << ',' << frame_number_ << ',' << used.exposure_100us << ',' << used.gain_16ths << std::endl;
  const int count = ++frame_number_;
  frame_id_ ^= 1;
  // Of a lost frame only the payload's header comes: the driver counts it.
  const bool lost = faults_.lost_every > 0 && count % faults_.lost_every == 0;
  const bool damaged = faults_.damaged_every > 0 && count % faults_.damaged_every == 0;
  constexpr std::uint8_t kEndOfFrame = 2, kTimeStamp = 4, kSourceClock = 8, kError = 0x40, kEndOfHeader = 0x80;
  const auto microseconds = static_cast<std::uint32_t>(static_cast<std::uint64_t>(now * 1e6));
  payload_ = {kPayloadHeaderBytes, static_cast<std::uint8_t>(kEndOfHeader | kTimeStamp | kSourceClock | kEndOfFrame |
                                                             frame_id_ | (damaged ? kError : 0))};
  append_le(payload_, microseconds, 4);
  append_le(payload_, microseconds, 4);
  append_le(payload_, microseconds / 1000 & 0x7ff, 2);
  const FrameSize size = kSizes[frame_ - 1];
  Bytes picture;
  if (!lost) picture = sensor_.picture(kEncodings[format_ - 1], size.width, size.height);
  if (damaged) picture.resize(picture.size() / 2);
  payload_.insert(payload_.end(), picture.begin(), picture.end());
  sent_ = 0;
}

void UvcCamera::send_frame() {
  while (!payload_.empty() && !waiting_.empty()) {
    const UsbRequest request = waiting_.front();
    waiting_.pop_front();
    const std::size_t count = std::min<std::size_t>(request.length, payload_.size() - sent_);
    usb_.answer(request, 0, std::span(payload_).subspan(sent_, count));
    sent_ += count;
    if (sent_ == payload_.size()) payload_.clear();
  }
}

}  // namespace hdr::sim
