#include "libhdr/io/internal/sphere_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

/// OpenImageIO's name for OpenEXR's attribute `envmap`.
bool is_envmap(const OIIO::ImageSpec& spec, const char* kind) {
  return spec.get_string_attribute("textureformat") == std::string(kind) + " Environment";
}

Image<float> placed(const Image<float>& data, const OIIO::ImageSpec& spec) {
  if (data.channels() == 0) return {};
  Image<float> picture(spec.full_width, spec.full_height, data.channels());
  const int left = spec.x - spec.full_x, top = spec.y - spec.full_y;
  const int first_x = std::max(0, left), last_x = std::min(picture.width(), left + data.width());
  const int first_y = std::max(0, top), last_y = std::min(picture.height(), top + data.height());
  if (first_x >= last_x) return picture;
  const std::size_t samples = static_cast<std::size_t>(last_x - first_x) * static_cast<std::size_t>(data.channels());
  for (int y = first_y; y < last_y; ++y) {
    std::memcpy(picture.pixel(first_x, y), data.pixel(first_x - left, y - top), samples * sizeof(float));
  }
  return picture;
}

/// Bilinear resampling from corner-centred pixels, u = x/(W-1) and v = y/(H-1), to ours, u = (x+0.5)/W.
Image<float> from_corner_centred(const Image<float>& map) {
  if (map.empty()) return {};
  const int w = map.width(), h = map.height();
  Image<float> ours(map.size(), map.channels());
  for_rows(h, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const double sy = (y + 0.5) / h * (h - 1);
      const int y0 = std::min(static_cast<int>(sy), h - 1), y1 = std::min(y0 + 1, h - 1);
      for (int x = 0; x < w; ++x) {
        const double sx = (x + 0.5) / w * (w - 1);
        const int x0 = std::min(static_cast<int>(sx), w - 1), x1 = std::min(x0 + 1, w - 1);
        const double fx = sx - x0, fy = sy - y0;
        for (int c = 0; c < map.channels(); ++c) {
          const double above = (1 - fx) * map(x0, y0, c) + fx * map(x1, y0, c);
          const double below = (1 - fx) * map(x0, y1, c) + fx * map(x1, y1, c);
          ours(x, y, c) = static_cast<float>((1 - fy) * above + fy * below);
        }
      }
    }
  });
  return ours;
}

}  // namespace

void place_in_display_window(RadianceMap& map, const OIIO::ImageSpec& spec, const std::string& name,
                             std::vector<std::string>& warnings) {
  const bool same = spec.x == spec.full_x && spec.y == spec.full_y && spec.width == spec.full_width &&
                    spec.height == spec.full_height;
  const bool is_sphere = spec.find_attribute("textureformat") != nullptr;  // six faces: the display window is one
  if (same || is_sphere || spec.full_width < 1 || spec.full_height < 1) return;
  constexpr double kMostEmptySpace = 256;  // times the pixels there are
  if (1.0 * spec.full_width * spec.full_height > kMostEmptySpace * spec.width * spec.height) {
    throw Error(fmt::format("{}: {} x {} pixels in a display window of {} x {}; crop the display window", name,
                            spec.width, spec.height, spec.full_width, spec.full_height));
  }
  for (Image<float>* plane : {&map.rgb, &map.alpha, &map.stddev}) *plane = placed(*plane, spec);
  warnings.push_back(fmt::format("{}: its {} x {} pixels were placed at {},{} of the {} x {} picture", name, spec.width,
                                 spec.height, spec.x - spec.full_x, spec.y - spec.full_y, spec.full_width,
                                 spec.full_height));
}

std::string projection_text(const OIIO::ImageSpec& spec) {
  const std::string ours = spec.get_string_attribute("hdr:projection");
  return ours.empty() && is_envmap(spec, "LatLong") ? "latlong" : ours;
}

void take_projection(RadianceMap& map, const OIIO::ImageSpec& spec, const std::string& name,
                     std::vector<std::string>& warnings) {
  map.projection = projection_text(spec);
  const bool by_others = spec.get_string_attribute("hdr:projection").empty();
  if (by_others && is_envmap(spec, "LatLong")) {
    for (Image<float>* plane : {&map.rgb, &map.alpha, &map.stddev}) *plane = from_corner_centred(*plane);
    warnings.push_back(name + ": OpenEXR envmap: resampled from pixels centred on the poles and the seam");
  } else if (by_others && is_envmap(spec, "CubeFace")) {
    warnings.push_back(name + ": OpenEXR cube envmap: six faces, one above the other, as they are in the file");
  }
}

}  // namespace hdr::internal
