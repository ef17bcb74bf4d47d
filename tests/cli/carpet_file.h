#pragma once
#include "libhdr/io/write.h"
#include "tests/support/carpet.h"

namespace hdr::test {

/// A lat-long of 1024 x 512.
inline void write_carpet(const std::filesystem::path& path, const Carpet& carpet = Carpet()) {
  constexpr int kWidth = 1024;
  RadianceMap map;
  map.rgb = Image<float>(kWidth, kWidth / 2, 3);
  map.projection = "latlong";
  for (int y = 0; y < map.rgb.height(); ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double light = carpet(dir_from_latlong((x + 0.5) / kWidth, (y + 0.5) / map.rgb.height()));
      for (int c = 0; c < 3; ++c) map.rgb(x, y, c) = static_cast<float>(light * (0.9 + 0.1 * c));
    }
  }
  write_map(path, map, {}, {SampleType::kFloat, "zip"});
}

}  // namespace hdr::test
