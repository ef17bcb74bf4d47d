#pragma once
#include "libhdr/io/read.h"

namespace hdr::internal {

// read_photo and read_photo_header without the refusal of an unusable EXIF time, for callers that bring their own
// times.
Photo decode_photo(const Path& path);
PhotoHeader decode_photo_header(const Path& path);

}  // namespace hdr::internal
