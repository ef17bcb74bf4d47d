#pragma once
#include "libhdr/core/photo.h"

namespace hdr::bench {

/// OpenImageIO alone, as a program that uses nothing else would call it. Both throw Error.
Image<float> read_by_oiio(const Path& path);
void write_by_oiio(const Path& path, View<const float> map, bool half, const std::string& compression);

}  // namespace hdr::bench
