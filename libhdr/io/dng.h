#pragma once
// Raw photographs in files: Adobe's Digital Negative, DNG 1.4 [DNG14], which every raw developer opens.
#include <string>

#include "libhdr/core/mosaic.h"
#include "libhdr/core/photo.h"

namespace hdr {

/// The sensor's codes as they are, uncompressed in 16 bits, with CFA pattern, black and white levels, and the exposure
/// in EXIF. The colour matrix, which the format demands and no camera of ours knows, is that of sRGB's primaries, and
/// the neutral is (1, 1, 1). read_photo reads the file as demosaic() gives it. Throws Error.
void write_dng(const Path& path, const Mosaic& mosaic, const std::string& camera);

/// The mosaic of a DNG file, as stored (EXIF orientation is not applied), of any maker. Throws Error: missing, damaged,
/// or without a Bayer pattern of 2x2 pixels in red, green and blue.
Mosaic read_dng(const Path& path);

}  // namespace hdr
