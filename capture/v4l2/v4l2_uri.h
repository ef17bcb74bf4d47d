#pragma once
// V4L2 cameras by name: "v4l2:/dev/video0?OPTIONS". OPTIONS are NAME=VALUE, joined by &:
//   format=YUYV   only this format, by its four-character code
//   size=640x480  only this size
//   black=64      the code of raw formats that means no light, which V4L2 does not know
#include <cstdint>
#include <optional>
#include <string>

#include "libhdr/core/image.h"

namespace hdr::v4l2 {

inline constexpr const char* kScheme = "v4l2:";

struct Uri {
  std::string path;
  std::optional<std::uint32_t> fourcc;
  std::optional<Size> size;
  double black_level = 0;
};

/// Throws CameraError kNotSupported, naming what is wrong.
Uri parse_uri(const std::string& uri);

}  // namespace hdr::v4l2
