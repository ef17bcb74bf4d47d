#pragma once
// Exposure in EXIF: read from what OpenImageIO found, written by ourselves (OpenImageIO 2.4 rounds rationals to six
// digits, writes no EXIF into PNG, and no ISO into TIFF).
#include <OpenImageIO/imageio.h>

#include <optional>
#include <string>

#include "libhdr/core/exposure.h"
#include "libhdr/core/photo.h"

namespace hdr::internal {

/// ExposureTime (else ShutterSpeedValue), FNumber (else ApertureValue), ISO under any of its names. A time that is
/// zero, negative or not finite is passed on as it stands, for require_usable_time to refuse; an aperture or ISO that
/// is not positive (lenses without contacts write 0) counts as absent.
Exposure exposure_from_exif(const OIIO::ImageInput& input, const Path& path);

/// A lens's horizontal field of an upright picture, and what says so.
struct ExifField {
  double degrees = 0;
  bool by_sensor = false;
};

/// The field of an upright picture of this size from FocalLengthIn35mmFilm: the focal length that gives the same
/// diagonal field on 36 x 24 mm (EXIF 2.3, tag 41989); without it from FocalLength and FocalPlaneXResolution, where the
/// picture is as wide as PixelXDimension says. nullopt: absent, or 0 for unknown.
std::optional<ExifField> field_from_exif(const OIIO::ImageInput& input, Size size);

/// Throws Error("FILE: exposure time ... in EXIF; ...") when the time is there and is not a positive number.
void require_usable_time(const Path& path, const Exposure& exposure);

/// EXIF holds rationals, of which OpenImageIO gives the nearest float: 0.0125f -> 0.0125, 0.01666...f -> 1/60.
double number_from_exif_float(float value);

/// What a photograph of this size says of its lens: the horizontal field, degrees, between 0 and 180.
struct Lens {
  double fov_degrees = 0;
  Size size;
};

/// Puts ExposureTime, FNumber and ISO into a JPEG, PNG or TIFF file just written: an APP1 segment, an eXIf chunk, an
/// EXIF directory. nd_stops has no place in EXIF and is not written. A lens becomes FocalLength behind a sensor 36 mm
/// wide, with FocalPlaneX- and YResolution and PixelX- and YDimension.
void embed_exif(const Path& file, const Exposure& exposure, const std::optional<Lens>& lens = {});
/// The bytes of a JPEG with `exposure` as its only EXIF.
std::string jpeg_with_exposure(const std::string& jpeg, const Exposure& exposure);

}  // namespace hdr::internal
