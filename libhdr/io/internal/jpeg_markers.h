#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr::internal {

/// What was found in a JPEG.
struct JpegLayout {
  int width = 0, height = 0;          ///< as the frame header promises
  int scans = 0;                      ///< more than one: progressive, or one for each channel
  std::vector<std::size_t> profiles;  ///< where the signatures of ICC profiles begin
  std::size_t end = 0;                ///< bytes up to and with the end marker; cameras pad what they stream
  bool huffman_tables = false;        ///< absent in many streams: the standard ones are meant
};

/// Walks through a JPEG's segments; nullopt for files that do not begin as a JPEG. libjpeg fills what is missing of a
/// truncated file with grey and says nothing, so a file whose picture has no end marker throws Error; so does a damaged
/// ICC profile.
std::optional<JpegLayout> vet_jpeg(const Path& path);
/// The same for a file in memory; `name` is for messages.
std::optional<JpegLayout> vet_jpeg(const std::string& bytes, const std::string& name);

}  // namespace hdr::internal
