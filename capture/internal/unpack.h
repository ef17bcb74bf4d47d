#pragma once
#include <cstdint>

#include "capture/frame.h"

namespace hdr::internal {

/// Channels of interleaved samples: 1 or 3; of kYuyv and kMjpeg, which are no samples of colours, 0.
int channels_of(PixelFormat pixels);
/// One row of `count` samples, whatever their packing, as words. `from` is little endian, or MIPI CSI-2's: 10 bits are
/// 4 high bytes and one with the 4 pairs of low bits, 12 bits are 2 high bytes and one with the 2 halves [CSI2].
void unpack_row(PixelFormat pixels, const std::uint8_t* from, int count, std::uint16_t* to);

/// One row of YUYV as RGB [BT601]. Chroma lies on the even pixels; odd ones have the mean of their neighbours'.
void rgb_from_yuyv_row(const std::uint8_t* from, int width, bool full_range, std::uint8_t* rgb);

}  // namespace hdr::internal
