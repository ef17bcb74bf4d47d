#include "capture/develop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "capture/internal/unpack.h"
#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/demosaic.h"
#include "libhdr/io/read.h"

namespace hdr {
namespace {

constexpr int kRowsAtOnce = 64;

std::string name_of(const Frame& frame) {
  return fmt::format("frame {}", frame.sequence);
}

/// The first byte of a row.
const std::uint8_t* row_of(const Frame& frame, int y) {
  return frame.bytes.data() + y * frame.format.stride_bytes;
}

void require_all_rows(const Frame& frame) {
  const FrameFormat& format = frame.format;
  const std::ptrdiff_t row = row_bytes_of(format.pixels, format.size.width);
  if (format.size.width < 1 || format.size.height < 1 || format.stride_bytes < row) {
    throw Error(fmt::format("{}: rows of {} bytes for {} of {}; the driver contradicts itself", name_of(frame),
                            format.stride_bytes, row, to_text(format)));
  }
  if (!frame.is_whole()) {
    throw Error(
        fmt::format("{}: short: {} bytes for {}; take it again", name_of(frame), frame.bytes.size(), to_text(format)));
  }
}

Image<std::uint8_t> from_yuyv(const Frame& frame) {
  Image<std::uint8_t> codes(frame.format.size, 3);
  for_rows(codes.height(), kRowsAtOnce, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      internal::rgb_from_yuyv_row(row_of(frame, y), codes.width(), frame.format.full_range, codes.row(y));
    }
  });
  return codes;
}

/// Grey and RGB: `code` maps a sample to the photograph's code.
template <class T, class Code>
Image<T> from_samples(const Frame& frame, const Code& code) {
  Image<T> codes(frame.format.size, 3);
  const int channels = internal::channels_of(frame.format.pixels), samples = codes.width() * channels;
  for_rows(codes.height(), kRowsAtOnce, [&](int first, int last) {
    std::vector<std::uint16_t> row(static_cast<std::size_t>(samples));
    for (int y = first; y < last; ++y) {
      internal::unpack_row(frame.format.pixels, row_of(frame, y), samples, row.data());
      for (int x = 0; x < codes.width(); ++x) {
        for (int c = 0; c < 3; ++c) {
          codes(x, y, c) = code(row[static_cast<std::size_t>(channels == 3 ? 3 * x + c : x)]);
        }
      }
    }
  });
  return codes;
}

Codes codes_from(const Frame& frame) {
  if (frame.format.pixels == PixelFormat::kYuyv) return from_yuyv(frame);
  if (bits_of(frame.format.pixels) == 8) {
    return from_samples<std::uint8_t>(frame, [](std::uint16_t sample) { return static_cast<std::uint8_t>(sample); });
  }
  const double black = frame.format.black_level, white = frame.format.white_level;
  if (!(white > black)) {
    throw Error(fmt::format("{}: white level {} is not above black level {}; check the camera's format", name_of(frame),
                            white, black));
  }
  return from_samples<std::uint16_t>(frame, [black, white](std::uint16_t sample) {
    return static_cast<std::uint16_t>(std::lround(65535 * std::clamp((sample - black) / (white - black), 0.0, 1.0)));
  });
}

}  // namespace

bool is_linear(const FrameFormat& format) {
  return is_bayer(format.pixels);
}

Exposure exposure_of(const Frame& frame, const DevelopOptions& options) {
  const ExposureSetting setting = frame.exposure.value_or(frame.requested);
  Exposure exposure{setting.seconds, options.f_number, std::nullopt, 0};
  if (options.iso) exposure.iso = *options.iso * setting.gain;
  return exposure;
}

Mosaic mosaic_from(const Frame& frame, const DevelopOptions& options) {
  const FrameFormat& format = frame.format;
  if (!is_bayer(format.pixels) || format.cfa == Cfa::kNone) {
    throw Error(
        fmt::format("{}: {} is not a sensor's mosaic; write .png, .jpg or .tif", name_of(frame), to_text(format)));
  }
  require_all_rows(frame);
  Mosaic mosaic;
  mosaic.codes = Image<std::uint16_t>(format.size, 1);
  for_rows(format.size.height, kRowsAtOnce, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      internal::unpack_row(format.pixels, row_of(frame, y), format.size.width, mosaic.codes.row(y));
    }
  });
  mosaic.cfa = format.cfa;
  mosaic.black_level.fill(format.black_level);
  mosaic.white_level = format.white_level;
  mosaic.exposure = exposure_of(frame, options);
  return mosaic;
}

Photo develop(const Frame& frame, const DevelopOptions& options) {
  const PixelFormat pixels = frame.format.pixels;
  if (is_bayer(pixels)) return demosaic(mosaic_from(frame, options));
  Photo photo;
  if (pixels == PixelFormat::kMjpeg) {
    photo = photo_from_jpeg(frame.bytes, name_of(frame));
  } else {
    require_all_rows(frame);
    photo.codes = codes_from(frame);
    photo.bits = bits_of(pixels) == 8 ? 8 : 16;
    photo.lossy = pixels == PixelFormat::kYuyv;
  }
  photo.exposure = exposure_of(frame, options);
  return photo;
}

}  // namespace hdr
