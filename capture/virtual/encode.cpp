#include "capture/virtual/encode.h"

#include <cstring>

#include "libhdr/core/error.h"
#include "libhdr/response/expose.h"

namespace hdr {
namespace {

template <class Code>
std::vector<std::uint8_t> packed_rows(const Image<Code>& codes, std::ptrdiff_t stride) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(stride) * static_cast<std::size_t>(codes.height()));
  for (int y = 0; y < codes.height(); ++y) {
    std::memcpy(bytes.data() + y * stride, codes.row(y), codes.row_samples() * sizeof(Code));
  }
  return bytes;
}

/// The codes of a colour photograph by a camera with this response.
template <class Code>
Image<Code> rgb_codes(View<const float> radiance, double gain, const VirtualSensor& sensor, int bits,
                      std::uint64_t seed) {
  Sensor model;
  model.response = response_from_name(sensor.response, bits).value();
  model.noise = sensor.noise;
  model.sensitivity = gain;
  Exposure unit;
  unit.seconds = 1;
  return std::get<Image<Code>>(std::move(expose(radiance, unit, model, seed).codes));
}

}  // namespace

std::vector<std::uint8_t> encode(View<const float> radiance, double gain, const VirtualSensor& sensor,
                                 const FrameFormat& format, std::uint64_t seed) {
  switch (format.pixels) {
    case PixelFormat::kRgb8:
      return packed_rows(rgb_codes<std::uint8_t>(radiance, gain, sensor, 8, seed), format.stride_bytes);
    case PixelFormat::kRgb16:
      return packed_rows(rgb_codes<std::uint16_t>(radiance, gain, sensor, 16, seed), format.stride_bytes);
    default:
      throw Error("virtual camera: " + to_text(format) + " cannot be made; choose another format");
  }
}

}  // namespace hdr
