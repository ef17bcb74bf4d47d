#include "tools/hdr/backplate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/filter/resize.h"
#include "libhdr/filter/tonemap.h"
#include "libhdr/io/read.h"
#include "tools/hdr/image_input.h"
#include "tools/hdr/pipeline.h"

namespace hdr::tools {
namespace {

bool has_extension(const std::string& path, std::initializer_list<const char*> known) {
  std::string extension = Path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(known.begin(), known.end(), extension) != known.end();
}

// Radiance of the brightest code of green: what becomes 1.
double white_of(const Response& response) {
  return response.exposure(1, (1 << response.bits) - 1);
}

RadianceMap linearised(const Photo& photo, const Response& response) {
  RadianceMap map;
  map.rgb = Image<float>(photo.size(), 3);
  const double white = white_of(response);
  std::array<std::vector<float>, 3> tables;
  for (int c = 0; c < 3; ++c) {
    tables[static_cast<std::size_t>(c)] = response.exposure_table(c);
    for (float& value : tables[static_cast<std::size_t>(c)]) value = static_cast<float>(value / white);
  }
  std::visit(
      [&](const auto& codes) {
        for_rows(photo.height(), 16, [&](int first, int last) {
          for (int y = first; y < last; ++y)
            for (int k = 0; k < 3 * photo.width(); ++k)
              map.rgb.row(y)[k] = tables[static_cast<std::size_t>(k % 3)][codes.row(y)[k]];
        });
      },
      photo.codes);
  return map;
}

Image<std::uint8_t> codes_through(const Response& response, View<const float> rgb) {
  Image<std::uint8_t> codes(rgb.size(), 3);
  const double white = white_of(response);
  std::array<std::vector<double>, 3> thresholds;
  for (int c = 0; c < 3; ++c) thresholds[static_cast<std::size_t>(c)] = response.exposure_thresholds(c);
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int k = 0; k < 3 * rgb.width(); ++k) {
        const std::vector<double>& steps = thresholds[static_cast<std::size_t>(k % 3)];
        const auto code = std::upper_bound(steps.begin(), steps.end(), rgb.row(y)[k] * white) - steps.begin();
        codes.row(y)[k] = static_cast<std::uint8_t>(code >> (response.bits - 8));
      }
    }
  });
  return codes;
}

}  // namespace

Backplate::Backplate(Run& run, const std::string& path, const std::string& response, int width) {
  is_map_ = has_extension(path, {".exr", ".hdr", ".pfm", ".xyze"});
  if (response.empty()) {
    ReadMap source = read_map(path);
    // A picture is taken for sRGB: that is no fault of a background.
    for (const std::string& warning : source.warnings)
      if (is_map_) run.warn(warning);
    light_ = std::move(source.map);
  } else {
    const Photo photo = read_photo(path);
    response_ = known_response(response, photo.bits);
    if (!response_) throw Error("--response: give a file of `hdr calibrate`, srgb, linear or gamma:2.2");
    light_ = linearised(photo, *response_);
  }
  if (width > 0 && width != light_.rgb.width()) {
    const double scale = static_cast<double>(width) / light_.rgb.width();
    const int height = std::max(1, static_cast<int>(std::lround(scale * light_.rgb.height())));
    light_.rgb = resize(light_.rgb, {width, height});
    light_.alpha = {};
    light_.stddev = {};
  }
}

void Backplate::write(Run& run, const std::string& path, const RadianceMap& picture, const Provenance& provenance,
                      const WriteOptions& options) const {
  if (!has_extension(path, {".png", ".jpg", ".jpeg"}) || (!is_map_ && !response_)) {
    return write_image(run, path, picture, provenance, options);
  }
  run.stage("write", [&] {
    if (response_) return write_picture(path, codes_through(*response_, picture.rgb));
    const double stops = metered_stops(light_.rgb);
    run.answer["stops"] = stops;
    run.say(fmt::format("shown at {:+.2f} stops: the background's log-average is 18 % grey", stops));
    write_picture(path, tonemap(picture.rgb, stops));
  });
  run.say("wrote " + path);
}

}  // namespace hdr::tools
