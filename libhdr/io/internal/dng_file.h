#pragma once
#include <OpenImageIO/imageio.h>

#include <memory>

#include "libhdr/core/photo.h"

namespace hdr::internal {

/// Extensions of cameras' raw files: .dng, .cr2, .nef, .arw ...
bool is_raw_name(const Path& path);

/// A raw photograph as a picture of three 16-bit channels, demosaiced when its first row is asked for. OpenImageIO's
/// own reader of raw files renders them for looking: balanced, brightened, in sRGB. Throws Error.
std::shared_ptr<OIIO::ImageInput> open_raw(const Path& path);

}  // namespace hdr::internal
