#include "capture/v4l2/formats.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace hdr::v4l2 {
namespace {

constexpr std::array kCodes = {
    FormatCode{V4L2_PIX_FMT_GREY, PixelFormat::kGrey8, Cfa::kNone},
    FormatCode{V4L2_PIX_FMT_Y10, PixelFormat::kGrey10, Cfa::kNone},
    FormatCode{V4L2_PIX_FMT_Y12, PixelFormat::kGrey12, Cfa::kNone},
    FormatCode{V4L2_PIX_FMT_Y16, PixelFormat::kGrey16, Cfa::kNone},
    FormatCode{V4L2_PIX_FMT_RGB24, PixelFormat::kRgb8, Cfa::kNone},
    FormatCode{V4L2_PIX_FMT_YUYV, PixelFormat::kYuyv, Cfa::kNone},
    FormatCode{V4L2_PIX_FMT_MJPEG, PixelFormat::kMjpeg, Cfa::kNone},
    FormatCode{V4L2_PIX_FMT_JPEG, PixelFormat::kMjpeg, Cfa::kNone},
    FormatCode{V4L2_PIX_FMT_SRGGB8, PixelFormat::kBayer8, Cfa::kRggb},
    FormatCode{V4L2_PIX_FMT_SBGGR8, PixelFormat::kBayer8, Cfa::kBggr},
    FormatCode{V4L2_PIX_FMT_SGRBG8, PixelFormat::kBayer8, Cfa::kGrbg},
    FormatCode{V4L2_PIX_FMT_SGBRG8, PixelFormat::kBayer8, Cfa::kGbrg},
    FormatCode{V4L2_PIX_FMT_SRGGB10, PixelFormat::kBayer10, Cfa::kRggb},
    FormatCode{V4L2_PIX_FMT_SBGGR10, PixelFormat::kBayer10, Cfa::kBggr},
    FormatCode{V4L2_PIX_FMT_SGRBG10, PixelFormat::kBayer10, Cfa::kGrbg},
    FormatCode{V4L2_PIX_FMT_SGBRG10, PixelFormat::kBayer10, Cfa::kGbrg},
    FormatCode{V4L2_PIX_FMT_SRGGB12, PixelFormat::kBayer12, Cfa::kRggb},
    FormatCode{V4L2_PIX_FMT_SBGGR12, PixelFormat::kBayer12, Cfa::kBggr},
    FormatCode{V4L2_PIX_FMT_SGRBG12, PixelFormat::kBayer12, Cfa::kGrbg},
    FormatCode{V4L2_PIX_FMT_SGBRG12, PixelFormat::kBayer12, Cfa::kGbrg},
    FormatCode{V4L2_PIX_FMT_SRGGB16, PixelFormat::kBayer16, Cfa::kRggb},
    FormatCode{V4L2_PIX_FMT_SBGGR16, PixelFormat::kBayer16, Cfa::kBggr},
    FormatCode{V4L2_PIX_FMT_SGRBG16, PixelFormat::kBayer16, Cfa::kGrbg},
    FormatCode{V4L2_PIX_FMT_SGBRG16, PixelFormat::kBayer16, Cfa::kGbrg},
    FormatCode{V4L2_PIX_FMT_SRGGB10P, PixelFormat::kBayer10Packed, Cfa::kRggb},
    FormatCode{V4L2_PIX_FMT_SBGGR10P, PixelFormat::kBayer10Packed, Cfa::kBggr},
    FormatCode{V4L2_PIX_FMT_SGRBG10P, PixelFormat::kBayer10Packed, Cfa::kGrbg},
    FormatCode{V4L2_PIX_FMT_SGBRG10P, PixelFormat::kBayer10Packed, Cfa::kGbrg},
    FormatCode{V4L2_PIX_FMT_SRGGB12P, PixelFormat::kBayer12Packed, Cfa::kRggb},
    FormatCode{V4L2_PIX_FMT_SBGGR12P, PixelFormat::kBayer12Packed, Cfa::kBggr},
    FormatCode{V4L2_PIX_FMT_SGRBG12P, PixelFormat::kBayer12Packed, Cfa::kGrbg},
    FormatCode{V4L2_PIX_FMT_SGBRG12P, PixelFormat::kBayer12Packed, Cfa::kGbrg},
};

}  // namespace

std::span<const FormatCode> format_codes() {
  return kCodes;
}

const FormatCode* find_format(std::uint32_t fourcc) {
  const auto found = std::ranges::find(kCodes, fourcc, &FormatCode::fourcc);
  return found == kCodes.end() ? nullptr : &*found;
}

const FormatCode* find_format(PixelFormat pixels, Cfa cfa) {
  const auto found =
      std::ranges::find_if(kCodes, [&](const FormatCode& c) { return c.pixels == pixels && c.cfa == cfa; });
  return found == kCodes.end() ? nullptr : &*found;
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (int k = 0; k < 4; ++k) text += static_cast<char>(fourcc >> (8 * k) & 0x7f);
  return text;
}

FrameFormat frame_format(const FormatCode& code, Size size) {
  FrameFormat format;
  format.pixels = code.pixels;
  format.cfa = code.cfa;
  format.size = size;
  format.stride_bytes = row_bytes_of(code.pixels, size.width);
  format.white_level = std::exp2(bits_of(code.pixels)) - 1;
  return format;
}

bool better_for_brackets(const FrameFormat& a, const FrameFormat& b) {
  const auto rank = [](const FrameFormat& f) {
    const bool coloured = f.cfa != Cfa::kNone || f.pixels == PixelFormat::kYuyv || f.pixels == PixelFormat::kRgb8;
    return std::tuple(is_bayer(f.pixels), bits_of(f.pixels), std::int64_t{f.size.width} * f.size.height,
                      f.pixels != PixelFormat::kMjpeg, coloured);
  };
  return rank(a) > rank(b);
}

}  // namespace hdr::v4l2
