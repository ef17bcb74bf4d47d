#pragma once
// Pixel formats by their four-character codes, which V4L2 and libcamera (as DRM's) name differently.
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "capture/frame.h"

namespace hdr::v4l2 {

struct FormatCode {
  std::uint32_t fourcc;
  PixelFormat pixels;
  Cfa cfa;
};

/// Every format that we know, in no order of preference.
std::span<const FormatCode> format_codes();
const FormatCode* find_format(std::uint32_t fourcc);
const FormatCode* find_format(PixelFormat pixels, Cfa cfa);

/// "pRAA": a code's four characters.
std::string fourcc_text(std::uint32_t fourcc);

/// The format with the levels that its bits have: the device knows its black level, V4L2 does not tell.
FrameFormat frame_format(const FormatCode& code, Size size);

/// Whether brackets rather have `a` than `b`: raw, then more bits, then more pixels, then uncompressed, then coloured.
bool better_for_brackets(const FrameFormat& a, const FrameFormat& b);

}  // namespace hdr::v4l2
