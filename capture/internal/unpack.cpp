#include "capture/internal/unpack.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"

namespace hdr::internal {
namespace {

std::uint8_t code_from(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

void unpack_mipi10(const std::uint8_t* from, int count, std::uint16_t* to) {
  for (int k = 0; k < count; ++k) {
    const std::uint8_t* group = from + 5 * (k / 4);
    const int low = group[4] >> (2 * (k % 4)) & 3;
    to[k] = static_cast<std::uint16_t>(group[k % 4] << 2 | low);
  }
}

void unpack_mipi12(const std::uint8_t* from, int count, std::uint16_t* to) {
  for (int k = 0; k < count; ++k) {
    const std::uint8_t* group = from + 3 * (k / 2);
    const int low = group[2] >> (4 * (k % 2)) & 15;
    to[k] = static_cast<std::uint16_t>(group[k % 2] << 4 | low);
  }
}

}  // namespace

int channels_of(PixelFormat pixels) {
  switch (pixels) {
    case PixelFormat::kRgb8:
    case PixelFormat::kRgb16:
      return 3;
    case PixelFormat::kYuyv:
    case PixelFormat::kMjpeg:
      return 0;
    default:
      return 1;
  }
}

void unpack_row(PixelFormat pixels, const std::uint8_t* from, int count, std::uint16_t* to) {
  HDR_ASSERT(channels_of(pixels) > 0);
  if (pixels == PixelFormat::kBayer10Packed) return unpack_mipi10(from, count, to);
  if (pixels == PixelFormat::kBayer12Packed) return unpack_mipi12(from, count, to);
  if (bits_of(pixels) == 8) {
    std::copy_n(from, count, to);
    return;
  }
  for (int k = 0; k < count; ++k) to[k] = static_cast<std::uint16_t>(from[2 * k] | from[2 * k + 1] << 8);
}

void rgb_from_yuyv_row(const std::uint8_t* from, int width, bool full_range, std::uint8_t* rgb) {
  // [BT601] 2.5.1 to 2.5.3: E'Y of the primaries, and differences that run over -0.5 .. 0.5.
  constexpr double kRed = 0.299, kBlue = 0.114, kGreen = 1 - kRed - kBlue;
  const double luma_black = full_range ? 0 : 16, luma_scale = full_range ? 1 : 255.0 / 219;
  const double chroma_scale = full_range ? 1 : 255.0 / 224;
  const int pairs = (width + 1) / 2;
  for (int x = 0; x < width; ++x) {
    const std::uint8_t* pair = from + 4 * (x / 2);
    const std::uint8_t* next = x % 2 == 1 && x / 2 + 1 < pairs ? pair + 4 : pair;
    const double luma = luma_scale * (pair[2 * (x % 2)] - luma_black);
    const double cb = chroma_scale * (0.5 * (pair[1] + next[1]) - 128);
    const double cr = chroma_scale * (0.5 * (pair[3] + next[3]) - 128);
    rgb[3 * x] = code_from(luma + 2 * (1 - kRed) * cr);
    rgb[3 * x + 1] = code_from(luma - 2 * (kBlue * (1 - kBlue) * cb + kRed * (1 - kRed) * cr) / kGreen);
    rgb[3 * x + 2] = code_from(luma + 2 * (1 - kBlue) * cb);
  }
}

}  // namespace hdr::internal
