#pragma once
// libcamera's pixel formats, which are DRM's, and ours.
#include <libcamera/pixel_format.h>

#include <optional>

#include "capture/frame.h"

namespace hdr::lc {

/// Absent for formats that we do not develop.
std::optional<FrameFormat> frame_format(const libcamera::PixelFormat& format, Size size);
std::optional<libcamera::PixelFormat> libcamera_format(PixelFormat pixels, Cfa cfa);

}  // namespace hdr::lc
