#include "libhdr/io/map_scale.h"

#include <cmath>
#include <cstdlib>

#include "libhdr/io/internal/oiio.h"

namespace hdr {
namespace {

std::optional<double> positive(double value) {
  return value > 0 && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

MapScale read_map_scale(const Path& path) {
  const OIIO::ImageSpec spec = internal::open_picture(path)->spec();
  MapScale scale;
  scale.exposure_unit = positive(std::strtod(spec.get_string_attribute("hdr:exposure_unit").c_str(), nullptr));
  scale.white_luminance = positive(spec.get_float_attribute("whiteLuminance", 0));
  scale.exposure_terms = spec.get_string_attribute("hdr:exposure_terms");
  return scale;
}

std::optional<double> read_camera_fov(const Path& path, Size size) {
  const OIIO::ImageSpec spec = internal::open_picture(path)->spec();
  if (spec.width != size.width || spec.height != size.height) return std::nullopt;
  const auto degrees = positive(std::strtod(spec.get_string_attribute("hdr:camera_fov").c_str(), nullptr));
  return degrees && *degrees < 180 ? degrees : std::nullopt;
}

}  // namespace hdr
