#pragma once
// A raw photograph: what a sensor behind a Bayer filter [Bayer76] counted, one sample a pixel, straight in the light.
// io/demosaic.h makes three colours of it, io/dng.h keeps it in a file.
#include <array>
#include <cstdint>

#include "libhdr/core/exposure.h"
#include "libhdr/core/image.h"

namespace hdr {

/// Colours of the top left 2x2 pixels, row by row.
enum class Cfa { kNone, kRggb, kBggr, kGrbg, kGbrg };

/// The channel (0 red, 1 green, 2 blue) that pixel (x, y) sees.
constexpr int cfa_channel(Cfa cfa, int x, int y) {
  constexpr int kChannels[5][4] = {{1, 1, 1, 1}, {0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}};
  return kChannels[static_cast<int>(cfa)][2 * (y & 1) + (x & 1)];
}

struct Mosaic {
  Image<std::uint16_t> codes;  ///< one channel
  Cfa cfa = Cfa::kRggb;
  std::array<double, 4>
      black_level{};           ///< the code that means no light, at the top left 2x2 pixels and every 2 further
  double white_level = 65535;  ///< the code at which the sensor or its converter saturates
  Exposure exposure;

  double black(int x, int y) const { return black_level[static_cast<std::size_t>(2 * (y & 1) + (x & 1))]; }
};

}  // namespace hdr
