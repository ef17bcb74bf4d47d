#pragma once
// What the simulated camera says of itself: USB 2.0 and UVC 1.1 descriptors of a bulk camera with manual controls.
#include <array>
#include <cstdint>
#include <vector>

#include "tests/camera/uvc/sensor.h"

namespace hdr::sim {

using Bytes = std::vector<std::uint8_t>;

void append_le(Bytes& bytes, std::uint32_t value, int count);

/// Formats are numbered from 1 on the wire in this order.
inline constexpr std::array kEncodings = {Encoding::kYuyv, Encoding::kBayer10Packed, Encoding::kBayer16,
                                          Encoding::kGrey8};
struct FrameSize {
  int width, height;
};
inline constexpr std::array kSizes = {FrameSize{320, 240}, FrameSize{640, 480}};
/// In units of 100 ns.
inline constexpr std::array<std::uint32_t, 4> kIntervals = {333333, 666666, 1000000, 2000000};

/// Entities and selectors that the video control interface answers to.
inline constexpr int kCameraTerminal = 1, kProcessingUnit = 2;

Bytes device_descriptor();
/// manual_exposure: whether the camera terminal has exposure controls at all.
Bytes configuration_descriptor(bool manual_exposure);
Bytes device_qualifier();
Bytes string_descriptor(int index);

}  // namespace hdr::sim
