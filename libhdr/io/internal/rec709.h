#pragma once
// Primaries: as files give them, and to Rec. 709.
#include <OpenImageIO/imageio.h>

#include <string>
#include <vector>

#include "libhdr/core/radiance.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

/// CIE XYZ as "primaries": what XYZE and LogLuv files hold.
inline constexpr Chromaticities kXyz{{1, 0}, {0, 1}, {0, 0}, {1.f / 3, 1.f / 3}};

/// OpenImageIO's attribute, as its EXR reader gives it.
void set_chromaticities(OIIO::ImageSpec& spec, const Chromaticities& xy);
/// Rec. 709 where the file says nothing, or what cannot be (no triangle, no white).
Chromaticities chromaticities_of(const OIIO::ImageSpec& spec);

/// XYZ of RGB, white having Y = 1; Rec. 709's for chromaticities that cannot be.
Mat3 xyz_matrix(const Chromaticities& xy);

bool is_rec709(const Chromaticities& xy);

/// RGB -> RGB with the same tristimulus values XYZ (OpenEXR's RGBtoXYZ and back): light stays what it is, and the white
/// of another white point is not made neutral. stddev is carried through as that of independent channels. Colours
/// outside Rec. 709 have negative components afterwards.
void convert_to_rec709(RadianceMap& map);

}  // namespace hdr::internal
