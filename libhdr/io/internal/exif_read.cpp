#include <OpenImageIO/tiffutils.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/output_file.h"

namespace hdr::internal {
namespace {

std::optional<double> number(const OIIO::ImageSpec& spec, const char* name) {
  const OIIO::ParamValue* found = spec.find_attribute(name);
  if (!found) return std::nullopt;
  if (found->type() == OIIO::TypeDesc::FLOAT) return number_from_exif_float(found->get_float());
  // get_float() knows the unsigned numbers of JPEG, but takes the signed ones of TIFF for 0; a rational is a pair.
  if (found->type() == OIIO::TypeDesc::INT) return found->get_int();
  return static_cast<double>(found->get_float());
}

std::optional<double> positive(std::optional<double> value) {
  return value && std::isfinite(*value) && *value > 0 ? value : std::nullopt;
}

/// APEX, EXIF 2.3 annex C: Tv = -log2 t, Av = 2 log2 N.
std::optional<double> seconds_from_apex(std::optional<double> tv) {
  return tv ? std::optional(std::exp2(-*tv)) : std::nullopt;
}
std::optional<double> f_number_from_apex(std::optional<double> av) {
  return av ? std::optional(std::exp2(*av / 2)) : std::nullopt;
}

std::optional<double> iso_of(const OIIO::ImageSpec& spec) {
  for (const char* name : {"Exif:PhotographicSensitivity", "Exif:ISOSpeedRatings", "Exif:ISOSpeed",
                           "Exif:RecommendedExposureIndex", "Exif:StandardOutputSensitivity", "ISOSpeedRatings"}) {
    constexpr double kSeeAnotherTag = 65535;  // a 16-bit field cannot hold more: EXIF 2.3 keeps the value elsewhere
    const auto value = positive(number(spec, name));
    if (value && *value != kSeeAnotherTag) return value;
  }
  return std::nullopt;
}

/// OpenImageIO 2.4 overlooks the ISO speed of TIFF files, a tag of variable count, but not in an EXIF block; and a TIFF
/// file is built like one.
std::optional<double> iso_of_tiff(const Path& path) {
  OIIO::ImageSpec exif;
  const std::string bytes = read_text(path);
  return OIIO::decode_exif(bytes, exif) ? iso_of(exif) : std::nullopt;
}

}  // namespace

double number_from_exif_float(float value) {
  // Decimals as people write them: the shortest text that gives this float back, when it is short.
  const std::string shortest = fmt::format("{}", value);
  constexpr std::size_t kShort = 6;
  const double decimal = std::strtod(shortest.c_str(), nullptr);
  std::size_t digits = 0;
  bool leading = true;
  for (const char c : shortest) {
    if (c == 'e') break;
    if (c >= '1' && c <= '9') leading = false;
    if (!leading && c >= '0' && c <= '9') ++digits;
  }
  if (digits <= kShort) return decimal;
  // Shutter times as cameras write them: 1/n.
  const double n = std::round(1.0 / value);
  if (n >= 1 && static_cast<float>(1.0 / n) == value) return 1.0 / n;
  return value;
}

Exposure exposure_from_exif(const OIIO::ImageInput& input, const Path& path) {
  const OIIO::ImageSpec& spec = input.spec();
  Exposure exposure;
  exposure.seconds = number(spec, "ExposureTime");
  if (!exposure.seconds) exposure.seconds = seconds_from_apex(number(spec, "Exif:ShutterSpeedValue"));
  exposure.f_number = positive(number(spec, "FNumber"));
  if (!exposure.f_number) exposure.f_number = positive(f_number_from_apex(number(spec, "Exif:ApertureValue")));
  exposure.iso = iso_of(spec);
  if (!exposure.iso && std::string(input.format_name()) == "tiff") exposure.iso = iso_of_tiff(path);
  return exposure;
}

namespace {

/// Focal length in pixels from FocalLength and the sensor's resolution, of a picture that is as wide as the camera
/// wrote it (PixelXDimension), on a sensor as cameras have them.
std::optional<double> focal_px_on_sensor(const OIIO::ImageSpec& spec) {
  constexpr double kNarrowest = 2, kWidest = 70;  // mm
  constexpr double kSquare = 0.02;
  const auto focal_mm = positive(number(spec, "Exif:FocalLength"));
  const auto per_unit = positive(number(spec, "Exif:FocalPlaneXResolution"));
  const auto per_unit_y = positive(number(spec, "Exif:FocalPlaneYResolution"));
  const auto written = positive(number(spec, "Exif:PixelXDimension"));
  if (!focal_mm || !per_unit || !written || *written != spec.width) return std::nullopt;
  if (per_unit_y && std::abs(*per_unit_y / *per_unit - 1) > kSquare) return std::nullopt;
  // EXIF 2.3, tag 41488: 2 inch, 3 centimetre; older cameras 4 millimetre, 5 micrometre.
  double unit_mm = 25.4;
  switch (spec.get_int_attribute("Exif:FocalPlaneResolutionUnit", 2)) {
    case 2:
      break;
    case 3:
      unit_mm = 10;
      break;
    case 4:
      unit_mm = 1;
      break;
    case 5:
      unit_mm = 1e-3;
      break;
    default:
      return std::nullopt;
  }
  const double sensor_mm = spec.width / *per_unit * unit_mm;
  if (!(sensor_mm > kNarrowest && sensor_mm < kWidest)) return std::nullopt;
  return *focal_mm / unit_mm * *per_unit;
}

/// From FocalLengthIn35mmFilm.
std::optional<double> focal_px_on_film(const OIIO::ImageSpec& spec) {
  const auto focal_mm = positive(number(spec, "Exif:FocalLengthIn35mmFilm"));
  if (!focal_mm) return std::nullopt;
  return *focal_mm / std::hypot(36, 24) * std::hypot(spec.width, spec.height);
}

}  // namespace

std::optional<ExifField> field_from_exif(const OIIO::ImageInput& input, Size size) {
  const auto on_film = focal_px_on_film(input.spec());
  const auto focal_px = on_film ? on_film : focal_px_on_sensor(input.spec());
  if (!focal_px) return std::nullopt;
  return ExifField{360 / std::numbers::pi * std::atan(0.5 * size.width / *focal_px), !on_film};
}

void require_usable_time(const Path& path, const Exposure& exposure) {
  if (!exposure.seconds || (std::isfinite(*exposure.seconds) && *exposure.seconds > 0)) return;
  throw Error(fmt::format("{}: the exposure time in EXIF is {} s; pass --times or --exposures", path.string(),
                          *exposure.seconds));
}

}  // namespace hdr::internal
