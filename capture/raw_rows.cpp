#include "capture/raw_rows.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

/// Samples and bytes of the smallest group that MIPI CSI-2 packs (RAW10: 4 in 5, RAW12: 2 in 3): the upper eight bits
/// of each sample first, then a byte with all their lower bits, the first sample's lowest.
struct Packing {
  std::size_t samples, bytes;
  int low_bits;
};

bool is_packed(PixelFormat pixels) {
  return pixels == PixelFormat::kBayer10Packed || pixels == PixelFormat::kBayer12Packed;
}

Packing packing_of(PixelFormat pixels) {
  return pixels == PixelFormat::kBayer10Packed ? Packing{4, 5, 2} : Packing{2, 3, 4};
}

}  // namespace

void unpack_row(std::span<const std::uint8_t> row, PixelFormat pixels, std::span<std::uint16_t> codes) {
  HDR_ASSERT(static_cast<std::ptrdiff_t>(row.size()) >= row_bytes_of(pixels, static_cast<int>(codes.size())));
  if (is_packed(pixels)) {
    const Packing packing = packing_of(pixels);
    for (std::size_t x = 0; x < codes.size(); ++x) {
      const std::size_t group = x / packing.samples * packing.bytes, place = x % packing.samples;
      const int low = row[group + packing.samples] >> (static_cast<int>(place) * packing.low_bits);
      codes[x] =
          static_cast<std::uint16_t>((row[group + place] << packing.low_bits) | (low & ((1 << packing.low_bits) - 1)));
    }
  } else if (bits_of(pixels) == 8) {
    for (std::size_t x = 0; x < codes.size(); ++x) codes[x] = row[x];
  } else {
    for (std::size_t x = 0; x < codes.size(); ++x) {
      codes[x] = static_cast<std::uint16_t>(row[2 * x] | (row[2 * x + 1] << 8));
    }
  }
}

void pack_row(std::span<const std::uint16_t> codes, PixelFormat pixels, std::span<std::uint8_t> row) {
  HDR_ASSERT(static_cast<std::ptrdiff_t>(row.size()) >= row_bytes_of(pixels, static_cast<int>(codes.size())));
  if (is_packed(pixels)) {
    const Packing packing = packing_of(pixels);
    for (std::size_t x = 0; x < codes.size(); ++x) {
      const std::size_t group = x / packing.samples * packing.bytes, place = x % packing.samples;
      if (place == 0) row[group + packing.samples] = 0;
      row[group + place] = static_cast<std::uint8_t>(codes[x] >> packing.low_bits);
      const int low = (codes[x] & ((1 << packing.low_bits) - 1)) << (static_cast<int>(place) * packing.low_bits);
      row[group + packing.samples] = static_cast<std::uint8_t>(row[group + packing.samples] | low);
    }
  } else if (bits_of(pixels) == 8) {
    for (std::size_t x = 0; x < codes.size(); ++x) row[x] = static_cast<std::uint8_t>(codes[x]);
  } else {
    for (std::size_t x = 0; x < codes.size(); ++x) {
      row[2 * x] = static_cast<std::uint8_t>(codes[x] & 0xff);
      row[2 * x + 1] = static_cast<std::uint8_t>(codes[x] >> 8);
    }
  }
}

int colour_of(Cfa cfa, int x, int y) {
  static constexpr int kColours[][4] = {{1, 1, 1, 1}, {0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}};
  return kColours[static_cast<int>(cfa)][(y & 1) * 2 + (x & 1)];
}

bool is_whole(const Frame& frame) {
  const FrameFormat& format = frame.format;
  if (format.pixels == PixelFormat::kMjpeg) return !frame.bytes.empty();
  if (format.size.height <= 0) return true;
  // The last row may end without its padding.
  const std::ptrdiff_t needed =
      (format.size.height - 1) * format.stride_bytes + row_bytes_of(format.pixels, format.size.width);
  return static_cast<std::ptrdiff_t>(frame.bytes.size()) >= needed;
}

std::span<const std::uint8_t> row_of(const Frame& frame, int y) {
  const std::ptrdiff_t start = y * frame.format.stride_bytes;
  const std::ptrdiff_t length = row_bytes_of(frame.format.pixels, frame.format.size.width);
  if (start + length > static_cast<std::ptrdiff_t>(frame.bytes.size())) {
    throw Error(fmt::format("frame {}: {} bytes are too few for {}; take it again", frame.sequence, frame.bytes.size(),
                            to_text(frame.format)));
  }
  return frame.bytes.subspan(static_cast<std::size_t>(start), static_cast<std::size_t>(length));
}

}  // namespace hdr
