#pragma once
#include <optional>
#include <string>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"

namespace hdr {

/// What a map written by this library says of its scale; each absent when the file does not say it.
struct MapScale {
  std::optional<double>
      exposure_unit;  ///< hdr:exposure_unit: the relative exposure at which radiance 1 gives the middle code
  std::optional<double> white_luminance;  ///< whiteLuminance: cd/m^2 of (1,1,1)
  std::string exposure_terms;  ///< hdr:exposure_terms: what the exposures are made of, "seconds f_number iso"
};

/// From the header of `path`; no pixel is decoded. Throws Error when it is not a picture.
MapScale read_map_scale(const Path& path);

/// The horizontal field, degrees, of the camera whose photographs were merged to a map: hdr:camera_fov. Absent when the
/// file does not say it, or is not of this size: a part of the map has another field. Throws as above.
std::optional<double> read_camera_fov(const Path& path, Size size);

}  // namespace hdr
