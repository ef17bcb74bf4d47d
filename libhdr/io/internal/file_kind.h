#pragma once
#include <string_view>

#include "libhdr/core/photo.h"

namespace hdr::internal {

/// What a file is by its first bytes; its name counts for raw photographs alone, whose beginnings are those of TIFF and
/// of films. Others (OpenImageIO would try twenty readers on any file, some of which damaged bytes kill) are not read.
enum class FileKind { kJpeg, kPng, kTiff, kExr, kRadiance, kPfm, kPnm, kWebp, kHeif, kBmp, kRaw, kOther };

FileKind kind_of(std::string_view first_bytes);
/// Reads the first bytes of a file. Throws Error when it cannot be read.
FileKind kind_of_file(const Path& path);

/// OpenImageIO's name of its reader; nullptr: read by ourselves, or not at all.
const char* oiio_reader_of(FileKind kind);

/// Pixels that one byte of such a file can hold at most, by the rules of its compression. A header that promises more
/// is damaged, and would ask for memory that the picture does not need.
double most_pixels_per_byte(FileKind kind);

}  // namespace hdr::internal
