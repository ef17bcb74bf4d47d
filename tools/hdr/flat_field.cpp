#include "tools/hdr/flat_field.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/io/read.h"

namespace hdr::tools {
namespace {

Image<float> linear_light(const Photo& photo, const Response& response) {
  if (photo.bits != response.bits) {
    throw Error(fmt::format("{}: {} bits, but the shots have {}; photograph the flat field as the shots, or give a map",
                            photo.path.string(), photo.bits, response.bits));
  }
  Image<float> light(photo.size(), 3);
  for (int c = 0; c < 3; ++c) {
    const std::vector<float> exposures = response.exposure_table(c);
    std::visit(
        [&](const auto& codes) {
          for (int y = 0; y < light.height(); ++y) {
            for (int x = 0; x < light.width(); ++x) light(x, y, c) = exposures[codes(x, y, c)];
          }
        },
        photo.codes);
  }
  return light;
}

}  // namespace

Image<float> read_flat_field(Run& run, const std::string& path, const Response& response, Size size) {
  if (path.empty()) return {};
  return run.stage("flat field", [&] {
    Image<float> flat;
    if (is_photo_name(path)) {
      flat = linear_light(read_photo(path), response);
    } else {
      flat = read_map(path).map.rgb;
    }
    if (flat.size() != size) {
      throw Error(fmt::format("{}: {}x{} pixels, but the map has {}x{}; a flat field has the size of the shots", path,
                              flat.width(), flat.height(), size.width, size.height));
    }
    for (int y = 0; y < size.height; ++y) {
      for (const float* v = flat.row(y); v != flat.row(y) + flat.row_samples(); ++v) {
        if (!(*v > 0)) {
          throw Error(
              fmt::format("{}: row {} has a pixel without light, which nothing can be divided by; photograph a "
                          "uniform bright scene",
                          path, y));
        }
      }
    }
    return flat;
  });
}

}  // namespace hdr::tools
