#pragma once
// The forward camera: radiance -> photograph. Ground truth for every test, and the heart of the virtual camera.
#include <cstdint>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/noise.h"
#include "libhdr/response/response.h"

namespace hdr {

struct Sensor {
  Response response;  ///< ln exposure per code; its largest code is reached at full well
  NoiseModel noise;
  double sensitivity = 1;  ///< share of full well that unit radiance fills in a relative exposure H = 1
};

/// Photographs `radiance` (3 channels, linear): level = radiance * sensitivity * H of full well, shot and read noise,
/// clipping at full well, the response, rounding to codes. Noise is a function of (seed, pixel, channel). NaN and
/// negative radiance count as zero.
Photo expose(View<const float> radiance, const Exposure& exposure, const Sensor& sensor, std::uint64_t seed);

/// Resamples `radiance` as a camera that was moved: photo pixel p (centres at integers) shows scene pixel
/// scene_from_photo * p, bilinearly in log radiance, mirrored at the border. Identity copies.
Image<float> shake(View<const float> radiance, const Mat3& scene_from_photo);

}  // namespace hdr
