#pragma once
// What a sensor sends down the wire: radiance -> the bytes of a frame.
#include <cstdint>
#include <string>
#include <vector>

#include "capture/frame.h"
#include "libhdr/response/noise.h"

namespace hdr {

struct VirtualSensor {
  std::string response = "srgb";  ///< of formats that are not Bayer, as response_from_name knows it
  NoiseModel noise;
};

/// `radiance` is width x height x 3; `gain` is the share of full well that unit radiance fills. Noise is a function of
/// (seed, pixel, channel). Bayer formats are linear, the others have the response; grey is luminance.
std::vector<std::uint8_t> encode(View<const float> radiance, double gain, const VirtualSensor& sensor,
                                 const FrameFormat& format, std::uint64_t seed);

}  // namespace hdr
