#include "capture/frame.h"

#include <fmt/format.h>

#include <vector>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

const char* name_of(Cfa cfa) {
  switch (cfa) {
    case Cfa::kRggb:
      return "RGGB";
    case Cfa::kBggr:
      return "BGGR";
    case Cfa::kGrbg:
      return "GRBG";
    case Cfa::kGbrg:
      return "GBRG";
    case Cfa::kNone:
      break;
  }
  return "Bayer";
}

std::string name_of(const FrameFormat& format) {
  switch (format.pixels) {
    case PixelFormat::kGrey8:
    case PixelFormat::kGrey10:
    case PixelFormat::kGrey12:
    case PixelFormat::kGrey16:
      return fmt::format("grey {} bit", bits_of(format.pixels));
    case PixelFormat::kRgb8:
    case PixelFormat::kRgb16:
      return fmt::format("RGB {} bit", bits_of(format.pixels));
    case PixelFormat::kYuyv:
      return "YUYV";
    case PixelFormat::kMjpeg:
      return "MJPEG";
    case PixelFormat::kBayer10Packed:
    case PixelFormat::kBayer12Packed:
      return fmt::format("{} {} bit packed", name_of(format.cfa), bits_of(format.pixels));
    default:
      return fmt::format("{} {} bit", name_of(format.cfa), bits_of(format.pixels));
  }
}

}  // namespace

int bits_of(PixelFormat pixels) {
  switch (pixels) {
    case PixelFormat::kGrey10:
    case PixelFormat::kBayer10:
    case PixelFormat::kBayer10Packed:
      return 10;
    case PixelFormat::kGrey12:
    case PixelFormat::kBayer12:
    case PixelFormat::kBayer12Packed:
      return 12;
    case PixelFormat::kGrey16:
    case PixelFormat::kRgb16:
    case PixelFormat::kBayer16:
      return 16;
    default:
      return 8;
  }
}

bool is_bayer(PixelFormat pixels) {
  switch (pixels) {
    case PixelFormat::kBayer8:
    case PixelFormat::kBayer10:
    case PixelFormat::kBayer12:
    case PixelFormat::kBayer16:
    case PixelFormat::kBayer10Packed:
    case PixelFormat::kBayer12Packed:
      return true;
    default:
      return false;
  }
}

std::ptrdiff_t row_bytes_of(PixelFormat pixels, int width) {
  switch (pixels) {
    case PixelFormat::kMjpeg:
      return 0;
    case PixelFormat::kGrey8:
    case PixelFormat::kBayer8:
      return width;
    case PixelFormat::kRgb8:
      return std::ptrdiff_t{3} * width;
    case PixelFormat::kRgb16:
      return std::ptrdiff_t{6} * width;
    case PixelFormat::kYuyv:
      return std::ptrdiff_t{4} * ((width + 1) / 2);
    case PixelFormat::kBayer10Packed:
      return std::ptrdiff_t{5} * ((width + 3) / 4);
    case PixelFormat::kBayer12Packed:
      return std::ptrdiff_t{3} * ((width + 1) / 2);
    default:
      return std::ptrdiff_t{2} * width;
  }
}

std::string to_text(const FrameFormat& format) {
  return fmt::format("{} {}x{}", name_of(format), format.size.width, format.size.height);
}

const char* name_of(Verified verified) {
  switch (verified) {
    case Verified::kMetadata:
      return "metadata";
    case Verified::kBrightness:
      return "brightness";
    case Verified::kNone:
      break;
  }
  return "none";
}

bool Frame::is_whole() const {
  if (format.pixels == PixelFormat::kMjpeg) return !bytes.empty();
  // The last row may end without its padding.
  const std::ptrdiff_t needed =
      (format.size.height - 1) * format.stride_bytes + row_bytes_of(format.pixels, format.size.width);
  return static_cast<std::ptrdiff_t>(bytes.size()) >= needed;
}

void Frame::detach() {
  auto copy = std::make_shared<std::vector<std::uint8_t>>(bytes.begin(), bytes.end());
  bytes = *copy;
  owner = std::move(copy);
  dmabuf = -1;
}

}  // namespace hdr
