#include "libhdr/io/internal/sphere_file.h"

#include <OpenEXR/ImfEnvmap.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

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

/// Bilinear, in the face that OpenEXR's own CubeMap names; border pixels of faces lie on the cube's edges.
Image<float> latlong_from_cube(const Image<float>& cube) {
  if (cube.empty()) return {};
  const Imath::Box2i window({0, 0}, {cube.width() - 1, cube.height() - 1});
  const int side = cube.width();
  Image<float> map(4 * side, 2 * side, cube.channels());
  for_rows(map.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < map.width(); ++x) {
        const Vec3 d = dir_from_latlong((x + 0.5) / map.width(), (y + 0.5) / map.height());
        Imf::CubeMapFace face;
        Imath::V2f in_face;
        Imf::CubeMap::faceAndPixelPosition(
            {static_cast<float>(d.x()), static_cast<float>(d.y()), static_cast<float>(d.z())}, window, face, in_face);
        const float x0 = std::min(std::floor(in_face.x), static_cast<float>(std::max(0, side - 2)));
        const float y0 = std::min(std::floor(in_face.y), static_cast<float>(std::max(0, side - 2)));
        const double fx = in_face.x - x0, fy = in_face.y - y0;
        const double weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
        for (int k = 0; k < 4; ++k) {
          if (weights[k] == 0) continue;
          const Imath::V2f corner(x0 + static_cast<float>(k % 2), y0 + static_cast<float>(k / 2));
          const Imath::V2f at = Imf::CubeMap::pixelPosition(face, window, corner);
          const float* from = cube.pixel(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)));
          for (int c = 0; c < map.channels(); ++c) map(x, y, c) += static_cast<float>(weights[k] * from[c]);
        }
      }
    }
  });
  return map;
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
  if (!ours.empty()) return ours;
  return is_envmap(spec, "LatLong") ? "latlong" : is_envmap(spec, "CubeFace") ? "openexr-cube" : "";
}

void take_projection(RadianceMap& map, const OIIO::ImageSpec& spec, const std::string& name,
                     std::vector<std::string>& warnings) {
  map.projection = projection_text(spec);
  const bool by_others = spec.get_string_attribute("hdr:projection").empty();
  if (by_others && is_envmap(spec, "LatLong")) {
    for (Image<float>* plane : {&map.rgb, &map.alpha, &map.stddev}) *plane = from_corner_centred(*plane);
    warnings.push_back(name + ": OpenEXR envmap: resampled from pixels centred on the poles and the seam");
  } else if (by_others && is_envmap(spec, "CubeFace")) {
    if (spec.height != 6 * spec.width) {
      throw Error(
          fmt::format("{}: a cube envmap of {} x {} pixels: six square faces one above the other are as high as six "
                      "times their width; is it damaged?",
                      name, spec.width, spec.height));
    }
    for (Image<float>* plane : {&map.rgb, &map.alpha, &map.stddev}) *plane = latlong_from_cube(*plane);
    map.projection = "latlong";
    warnings.push_back(fmt::format("{}: OpenEXR cube envmap: its faces were resampled to a lat-long of {} x {}", name,
                                   4 * spec.width, 2 * spec.width));
  }
}

}  // namespace hdr::internal
