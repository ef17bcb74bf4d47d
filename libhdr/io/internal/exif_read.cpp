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

std::optional<double> fov_from_exif(const OIIO::ImageInput& input, Size size) {
  const auto focal_mm = positive(number(input.spec(), "Exif:FocalLengthIn35mmFilm"));
  if (!focal_mm) return std::nullopt;
  const double film_mm = std::hypot(36, 24), focal_px = *focal_mm / film_mm * std::hypot(size.width, size.height);
  return 360 / std::numbers::pi * std::atan(0.5 * size.width / focal_px);
}

void require_usable_time(const Path& path, const Exposure& exposure) {
  if (!exposure.seconds || (std::isfinite(*exposure.seconds) && *exposure.seconds > 0)) return;
  throw Error(fmt::format("{}: the exposure time in EXIF is {} s; pass --times or --exposures", path.string(),
                          *exposure.seconds));
}

}  // namespace hdr::internal
