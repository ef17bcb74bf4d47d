#include "capture/develop.h"

#include <fmt/format.h>

#include <cstring>

namespace hdr {
namespace {

template <class Code>
Image<Code> rgb_codes(const Frame& frame) {
  const FrameFormat& format = frame.format;
  Image<Code> codes(format.size, 3);
  const std::size_t row_bytes = codes.row_samples() * sizeof(Code);
  const auto stride = static_cast<std::size_t>(format.stride_bytes);
  const auto height = static_cast<std::size_t>(format.size.height);
  if (stride < row_bytes || (height > 0 && frame.bytes.size() < (height - 1) * stride + row_bytes)) {
    throw Error(fmt::format("frame {}: {} bytes are too few for {}; take it again", frame.sequence, frame.bytes.size(),
                            to_text(format)));
  }
  for (int y = 0; y < format.size.height; ++y) {
    std::memcpy(codes.row(y), frame.bytes.data() + static_cast<std::size_t>(y) * stride, row_bytes);
  }
  return codes;
}

}  // namespace

Photo develop(const Frame& frame, const DevelopOptions& options) {
  Photo photo;
  const ExposureSetting exposure = frame.exposure.value_or(frame.requested);
  photo.exposure = {exposure.seconds, options.f_number, options.iso, 0};
  if (photo.exposure.iso) *photo.exposure.iso *= exposure.gain;
  switch (frame.format.pixels) {
    case PixelFormat::kRgb8:
      photo.bits = 8;
      photo.codes = rgb_codes<std::uint8_t>(frame);
      break;
    case PixelFormat::kRgb16:
      photo.bits = 16;
      photo.codes = rgb_codes<std::uint16_t>(frame);
      break;
    default:
      throw Error(fmt::format("frame {}: {} cannot be developed; choose another format of the camera", frame.sequence,
                              to_text(frame.format)));
  }
  return photo;
}

}  // namespace hdr
