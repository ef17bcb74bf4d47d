#pragma once
#include <string>

#include "libhdr/core/photo.h"

namespace hdr::internal {

/// A JPEG's bytes, vetted; empty for files that do not begin as a JPEG. libjpeg fills what is missing of a truncated
/// file with grey and says nothing, so a file whose picture has no end marker throws Error; so does a damaged ICC
/// profile. Whole profiles are made unrecognisable: OpenImageIO 2.4 reads beyond the end of some that real cameras
/// write, and crashes now and then; we have no use for them.
std::string vetted_jpeg(const Path& path);

}  // namespace hdr::internal
