#pragma once
// What a file says about the place of its pixels: OpenEXR's two windows, and maps of the sphere.
#include <OpenImageIO/imageio.h>

#include <string>
#include <vector>

#include "libhdr/core/radiance.h"

namespace hdr::internal {

/// OpenEXR keeps the pixels of a data window and says where it lies in the display window, which is the picture. Where
/// there is no data the picture is 0 (alpha 0); data outside is cut off. A note goes to `warnings`.
void place_in_display_window(RadianceMap& map, const OIIO::ImageSpec& spec, const std::string& name,
                             std::vector<std::string>& warnings);

/// hdr:projection, else OpenEXR's `envmap`. A lat-long envmap by others has the centres of its corner pixels ON the
/// poles and the seam (OpenEXR, Technical Introduction, "Environment Maps"): it is resampled to our pixel-centred grid
/// (core/sphere.h), which is noted in `warnings`. So is a cube envmap, whose faces have border pixels on the cube's
/// edges: it becomes a lat-long four times as wide as a face. Throws Error where there are no six square faces.
void take_projection(RadianceMap& map, const OIIO::ImageSpec& spec, const std::string& name,
                     std::vector<std::string>& warnings);

/// The projection of the file alone, "openexr-cube" too, without touching pixels; empty when the file says nothing.
std::string projection_text(const OIIO::ImageSpec& spec);

}  // namespace hdr::internal
