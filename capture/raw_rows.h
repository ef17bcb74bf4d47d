#pragma once
// Samples of grey and Bayer frames, whatever their packing.
#include <cstdint>
#include <span>

#include "capture/frame.h"

namespace hdr {

/// One row of a grey or Bayer frame as codes; `codes` has a place for each pixel and `row` the row's bytes.
void unpack_row(std::span<const std::uint8_t> row, PixelFormat pixels, std::span<std::uint16_t> codes);

/// The inverse; bits that a code should not have are dropped.
void pack_row(std::span<const std::uint16_t> codes, PixelFormat pixels, std::span<std::uint8_t> row);

/// 0 red, 1 green, 2 blue: the colour of pixel (x, y).
int colour_of(Cfa cfa, int x, int y);

/// The bytes of row y; what is missing at a frame's end is no row: throws Error for a frame that is too short.
std::span<const std::uint8_t> row_of(const Frame& frame, int y);

/// Whether the bytes can hold the picture that the format promises. A compressed frame can always.
bool is_whole(const Frame& frame);

}  // namespace hdr
