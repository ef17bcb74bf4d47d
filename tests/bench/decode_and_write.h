#pragma once
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"

namespace hdr::bench {

/// The work that no merge can do without: every JPEG decoded into memory (libjpeg-turbo, through OpenImageIO), as many
/// at a time as there are threads, and `map` written as half PIZ by OpenEXR. None of our own readers and writers.
void decode_and_write(const std::vector<Path>& shots, const Image<float>& map, const Path& output);

}  // namespace hdr::bench
