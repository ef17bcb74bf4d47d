#include "capture/libcamera/libcamera_formats.h"

#include <libcamera/formats.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hdr::lc {
namespace {

namespace f = libcamera::formats;

struct Row {
  libcamera::PixelFormat theirs;
  PixelFormat pixels;
  Cfa cfa;
};

/// Those that 0.0.3 and later versions both name.
constexpr std::array kRows = {
    Row{f::R8, PixelFormat::kGrey8, Cfa::kNone},
    Row{f::R10, PixelFormat::kGrey10, Cfa::kNone},
    Row{f::R12, PixelFormat::kGrey12, Cfa::kNone},
    Row{f::BGR888, PixelFormat::kRgb8, Cfa::kNone},  // DRM names the last byte first
    Row{f::YUYV, PixelFormat::kYuyv, Cfa::kNone},
    Row{f::MJPEG, PixelFormat::kMjpeg, Cfa::kNone},
    Row{f::SRGGB8, PixelFormat::kBayer8, Cfa::kRggb},
    Row{f::SBGGR8, PixelFormat::kBayer8, Cfa::kBggr},
    Row{f::SGRBG8, PixelFormat::kBayer8, Cfa::kGrbg},
    Row{f::SGBRG8, PixelFormat::kBayer8, Cfa::kGbrg},
    Row{f::SRGGB10, PixelFormat::kBayer10, Cfa::kRggb},
    Row{f::SBGGR10, PixelFormat::kBayer10, Cfa::kBggr},
    Row{f::SGRBG10, PixelFormat::kBayer10, Cfa::kGrbg},
    Row{f::SGBRG10, PixelFormat::kBayer10, Cfa::kGbrg},
    Row{f::SRGGB12, PixelFormat::kBayer12, Cfa::kRggb},
    Row{f::SBGGR12, PixelFormat::kBayer12, Cfa::kBggr},
    Row{f::SGRBG12, PixelFormat::kBayer12, Cfa::kGrbg},
    Row{f::SGBRG12, PixelFormat::kBayer12, Cfa::kGbrg},
    Row{f::SRGGB16, PixelFormat::kBayer16, Cfa::kRggb},
    Row{f::SBGGR16, PixelFormat::kBayer16, Cfa::kBggr},
    Row{f::SGRBG16, PixelFormat::kBayer16, Cfa::kGrbg},
    Row{f::SGBRG16, PixelFormat::kBayer16, Cfa::kGbrg},
    Row{f::SRGGB10_CSI2P, PixelFormat::kBayer10Packed, Cfa::kRggb},
    Row{f::SBGGR10_CSI2P, PixelFormat::kBayer10Packed, Cfa::kBggr},
    Row{f::SGRBG10_CSI2P, PixelFormat::kBayer10Packed, Cfa::kGrbg},
    Row{f::SGBRG10_CSI2P, PixelFormat::kBayer10Packed, Cfa::kGbrg},
    Row{f::SRGGB12_CSI2P, PixelFormat::kBayer12Packed, Cfa::kRggb},
    Row{f::SBGGR12_CSI2P, PixelFormat::kBayer12Packed, Cfa::kBggr},
    Row{f::SGRBG12_CSI2P, PixelFormat::kBayer12Packed, Cfa::kGrbg},
    Row{f::SGBRG12_CSI2P, PixelFormat::kBayer12Packed, Cfa::kGbrg},
};

}  // namespace

std::optional<FrameFormat> frame_format(const libcamera::PixelFormat& format, Size size) {
  const auto row = std::ranges::find_if(kRows, [&](const Row& r) { return r.theirs == format; });
  if (row == kRows.end()) return std::nullopt;
  FrameFormat result;
  result.pixels = row->pixels;
  result.cfa = row->cfa;
  result.size = size;
  result.stride_bytes = row_bytes_of(row->pixels, size.width);
  result.white_level = std::exp2(bits_of(row->pixels)) - 1;
  return result;
}

std::optional<libcamera::PixelFormat> libcamera_format(PixelFormat pixels, Cfa cfa) {
  const auto row = std::ranges::find_if(kRows, [&](const Row& r) { return r.pixels == pixels && r.cfa == cfa; });
  if (row == kRows.end()) return std::nullopt;
  return row->theirs;
}

}  // namespace hdr::lc
