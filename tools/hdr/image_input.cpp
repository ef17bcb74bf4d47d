#include "tools/hdr/image_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"

namespace hdr::tools {
namespace {

bool is_picture_name(const std::string& path) {
  std::string extension = Path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

struct Codes {
  Image<std::uint8_t> codes;
  std::int64_t clipped = 0;  ///< samples above 1
};

/// sRGB, 8 bits; alpha is not multiplied in, as PNG has it.
Codes codes_of(const RadianceMap& map) {
  Codes result{Image<std::uint8_t>(map.size(), map.alpha.empty() ? 3 : 4), 0};
  const auto of_rows = [&](int first, int last) {
    std::int64_t clipped = 0;
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < map.rgb.width(); ++x) {
        const double coverage = map.alpha.empty() ? 1.0 : std::clamp(map.alpha(x, y), 0.0f, 1.0f);
        for (int c = 0; c < 3; ++c) {
          const double value = coverage > 0 ? map.rgb(x, y, c) / coverage : 0.0;
          constexpr double kRounding = 1 + 1e-6;
          if (value > kRounding) ++clipped;
          result.codes(x, y, c) = static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(value)));
        }
        if (!map.alpha.empty()) result.codes(x, y, 3) = static_cast<std::uint8_t>(std::lround(255 * coverage));
      }
    }
    return clipped;
  };
  result.clipped = reduce_rows(map.rgb.height(), 16, std::int64_t{0}, of_rows,
                               [](std::int64_t& total, std::int64_t part) { total += part; });
  return result;
}

}  // namespace

RadianceMap read_image(Run& run, const std::string& path, const ReadMapOptions& options) {
  ReadMap source = run.stage("read", [&] { return read_map(path, options); });
  for (const std::string& warning : source.warnings) run.warn(warning);
  return std::move(source.map);
}

void write_image(Run& run, const std::string& path, const RadianceMap& map, const Provenance& provenance,
                 const WriteOptions& options) {
  run.stage("write", [&] {
    if (!is_picture_name(path)) return write_map(path, map, provenance, options);
    const Codes picture = codes_of(map);
    if (picture.clipped > 0) {
      run.warn(fmt::format("{}: {} samples above 1 were clipped; hdr tonemap keeps highlights apart", path,
                           picture.clipped));
    }
    write_picture(path, picture.codes);
  });
  run.say("wrote " + path);
}

}  // namespace hdr::tools
