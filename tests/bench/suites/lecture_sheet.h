#pragma once
#include <string>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr::bench {

struct Tile {
  Image<std::uint8_t> codes;       ///< 8-bit sRGB; all tiles of a sheet have one size
  std::vector<std::string> lines;  ///< under it
};

/// Tiles in rows of `across`, white, with their lines under them.
Image<std::uint8_t> contact_sheet(const std::vector<Tile>& tiles, int across);

}  // namespace hdr::bench
