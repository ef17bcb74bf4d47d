#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr::internal {

/// What was found in a JPEG.
struct JpegLayout {
  int scans = 0;                      ///< more than one: progressive, or one for each channel
  std::vector<std::size_t> profiles;  ///< where the signatures of ICC profiles begin
};

/// Walks through a JPEG's segments; nullopt for files that do not begin as a JPEG. libjpeg fills what is missing of a
/// truncated file with grey and says nothing, so a file whose picture has no end marker throws Error; so does a damaged
/// ICC profile.
std::optional<JpegLayout> vet_jpeg(const Path& path);

}  // namespace hdr::internal
