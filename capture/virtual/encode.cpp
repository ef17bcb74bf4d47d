#include "capture/virtual/encode.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/io/write.h"
#include "libhdr/response/expose.h"

namespace hdr {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes empty_frame(const FrameFormat& format) {
  return Bytes(static_cast<std::size_t>(format.stride_bytes) * static_cast<std::size_t>(format.size.height));
}

/// A colour photograph by a camera with this response.
Photo photo_of(View<const float> radiance, double gain, const VirtualSensor& sensor, int bits, std::uint64_t seed) {
  Sensor model;
  model.response = response_from_name(sensor.response, bits).value();
  model.noise = sensor.noise;
  model.sensitivity = gain;
  Exposure unit;
  unit.seconds = 1;
  return expose(radiance, unit, model, seed);
}

template <class Code>
Bytes rgb_bytes(const Photo& photo, const FrameFormat& format) {
  const auto& codes = std::get<Image<Code>>(photo.codes);
  Bytes bytes = empty_frame(format);
  for (int y = 0; y < codes.height(); ++y) {
    std::memcpy(bytes.data() + y * format.stride_bytes, codes.row(y), codes.row_samples() * sizeof(Code));
  }
  return bytes;
}

/// [BT601] 8-bit luma and colour differences; those of the even pixels.
Bytes yuyv_bytes(const Photo& photo, const FrameFormat& format) {
  const auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
  const double luma_black = format.full_range ? 0 : 16, luma_scale = format.full_range ? 1 : 219.0 / 255;
  const double chroma_scale = format.full_range ? 1 : 224.0 / 255;
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); };
  Bytes bytes = empty_frame(format);
  for (int y = 0; y < codes.height(); ++y) {
    std::uint8_t* to = bytes.data() + y * format.stride_bytes;
    for (int x = 0; x < codes.width(); ++x) {
      const std::uint8_t* rgb = codes.pixel(x, y);
      const double luma = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
      to[2 * x] = byte(luma_black + luma_scale * luma);
      if (x % 2 == 0) {
        to[2 * x + 1] = byte(128 + chroma_scale * (rgb[2] - luma) / 1.772);
        to[2 * x + 3] = byte(128 + chroma_scale * (rgb[0] - luma) / 1.402);
      }
    }
  }
  return bytes;
}

/// By the one JPEG writer of the toolkit, which writes files.
Bytes jpeg_bytes(Photo photo, std::uint64_t seed) {
  photo.lossy = true;
  const Path path = std::filesystem::temp_directory_path() / fmt::format("hdr-virtual-{}-{}.jpg", getpid(), seed);
  write_photo(path, photo);
  std::ifstream file(path, std::ios::binary);
  Bytes bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  return bytes;
}

void put_row(const std::vector<std::uint16_t>& codes, PixelFormat pixels, std::uint8_t* row) {
  if (pixels == PixelFormat::kBayer10Packed || pixels == PixelFormat::kBayer12Packed) {
    // MIPI CSI-2: the upper eight bits of each sample, then a byte with all their lower bits.
    const std::size_t group = pixels == PixelFormat::kBayer10Packed ? 4 : 2;
    const int low_bits = pixels == PixelFormat::kBayer10Packed ? 2 : 4;
    for (std::size_t x = 0; x < codes.size(); ++x) {
      std::uint8_t* to = row + x / group * (group + 1);
      const int low = codes[x] & ((1 << low_bits) - 1);
      to[x % group] = static_cast<std::uint8_t>(codes[x] >> low_bits);
      to[group] = static_cast<std::uint8_t>(to[group] | low << (static_cast<int>(x % group) * low_bits));
    }
  } else if (bits_of(pixels) == 8) {
    std::copy(codes.begin(), codes.end(), row);
  } else {
    for (std::size_t x = 0; x < codes.size(); ++x) {
      row[2 * x] = static_cast<std::uint8_t>(codes[x] & 0xff);
      row[2 * x + 1] = static_cast<std::uint8_t>(codes[x] >> 8);
    }
  }
}

/// The sensor's own samples: linear, with noise on both sides of the black level.
Bytes bayer_bytes(View<const float> radiance, double gain, const VirtualSensor& sensor, const FrameFormat& format,
                  std::uint64_t seed) {
  Bytes bytes = empty_frame(format);
  for_rows(radiance.height(), 16, [&](int first, int last) {
    std::vector<std::uint16_t> codes(static_cast<std::size_t>(radiance.width()));
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < radiance.width(); ++x) {
        const double light = radiance(x, y, cfa_channel(format.cfa, x, y)) * gain;
        const double level = light > 0 ? std::min(light, 1e6) : 0;
        const auto address = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(radiance.width()) +
                             static_cast<std::uint64_t>(x);
        const double noisy = level + sensor.noise.stddev(level) * Random(seed, address).normal();
        const double code = format.black_level + (format.white_level - format.black_level) * noisy;
        codes[static_cast<std::size_t>(x)] =
            static_cast<std::uint16_t>(std::lround(std::clamp(code, 0.0, format.white_level)));
      }
      put_row(codes, format.pixels, bytes.data() + y * format.stride_bytes);
    }
  });
  return bytes;
}

/// Luminance, through the camera's response.
Bytes grey_bytes(View<const float> radiance, double gain, const VirtualSensor& sensor, const FrameFormat& format,
                 std::uint64_t seed) {
  Image<float> grey(radiance.size(), 3);
  for (int y = 0; y < radiance.height(); ++y) {
    for (int x = 0; x < radiance.width(); ++x) {
      const float* rgb = radiance.pixel(x, y);
      std::fill_n(grey.pixel(x, y), 3, 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]);
    }
  }
  const Photo photo = photo_of(grey, gain, sensor, bits_of(format.pixels), seed);
  Bytes bytes = empty_frame(format);
  std::vector<std::uint16_t> codes(static_cast<std::size_t>(radiance.width()));
  for (int y = 0; y < radiance.height(); ++y) {
    std::visit(
        [&](const auto& image) {
          for (int x = 0; x < image.width(); ++x) codes[static_cast<std::size_t>(x)] = image(x, y, 1);
        },
        photo.codes);
    put_row(codes, format.pixels, bytes.data() + y * format.stride_bytes);
  }
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> encode(View<const float> radiance, double gain, const VirtualSensor& sensor,
                                 const FrameFormat& format, std::uint64_t seed) {
  if (is_bayer(format.pixels)) return bayer_bytes(radiance, gain, sensor, format, seed);
  switch (format.pixels) {
    case PixelFormat::kRgb8:
      return rgb_bytes<std::uint8_t>(photo_of(radiance, gain, sensor, 8, seed), format);
    case PixelFormat::kRgb16:
      return rgb_bytes<std::uint16_t>(photo_of(radiance, gain, sensor, 16, seed), format);
    case PixelFormat::kYuyv:
      return yuyv_bytes(photo_of(radiance, gain, sensor, 8, seed), format);
    case PixelFormat::kMjpeg:
      return jpeg_bytes(photo_of(radiance, gain, sensor, 8, seed), seed);
    default:
      return grey_bytes(radiance, gain, sensor, format, seed);
  }
}

}  // namespace hdr
