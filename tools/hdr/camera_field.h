#pragma once
// The field of the camera that took a picture, where the file says so.
#include <optional>
#include <string>

#include "libhdr/core/image.h"

namespace hdr::tools {

/// Horizontal, degrees: of a photograph from its EXIF, of a map from the photographs that were merged to it. nullopt:
/// not said, or the file is not the picture of this size.
std::optional<double> camera_field(const std::string& file, Size size);

}  // namespace hdr::tools
