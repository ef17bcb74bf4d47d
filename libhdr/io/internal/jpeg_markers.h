#pragma once
#include "libhdr/core/photo.h"

namespace hdr::internal {

/// Walks a JPEG's markers. libjpeg fills what is missing of a truncated file with grey and says nothing, so a file
/// whose picture has no end marker throws Error. So does a damaged ICC profile, on which OpenImageIO 2.4 crashes.
/// Files that do not begin as a JPEG pass.
void check_jpeg(const Path& path);

}  // namespace hdr::internal
