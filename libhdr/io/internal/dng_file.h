#pragma once
#include <OpenImageIO/imageio.h>

#include <memory>

#include "libhdr/core/photo.h"

namespace hdr::internal {

bool is_dng_name(const Path& path);

/// A DNG file as a picture of three 16-bit channels, demosaiced when its first row is asked for. OpenImageIO's own
/// reader of raw files renders them for looking: balanced, brightened, in sRGB. Throws Error.
std::shared_ptr<OIIO::ImageInput> open_dng(const Path& path);

}  // namespace hdr::internal
