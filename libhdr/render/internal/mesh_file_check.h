#pragma once
// What assimp 5.2 does not survive in damaged files.
#include "libhdr/core/photo.h"

namespace hdr {

/// Lower case, with the dot.
std::string extension_of(const Path& path);

/// Throws Error: a PLY whose header has no end (assimp looks for it without end), a glTF with a data URI that names no
/// media type (assimp reads what follows its slash, whether there is one or not).
void require_survivable(const Path& path);

}  // namespace hdr
