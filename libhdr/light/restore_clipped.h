#pragma once
// The missing light of clipped suns, from irradiance that was measured beside the probe.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// What a surface received, in the map's unit times steradians: a lux meter lying there faces +Y; a diffuse ball has
/// one such reading at every normal that was photographed, pi times its radiance over its albedo.
struct MeasuredIrradiance {
  Vec3 normal = Vec3::UnitY();
  Rgb irradiance = Rgb::Zero();
};

struct Restored {
  Image<float> rgb;
  int regions = 0;             ///< connected clipped regions on the sphere
  std::vector<Rgb> gains;      ///< by which each region's pixels were multiplied, at least 1
  Rgb residual = Rgb::Zero();  ///< rms over the measurements of what is still missing, relative to what was measured
};

/// A lat-long; pixels in which `clipped` (one channel, same size) is not 0 are multiplied by one number a region and
/// channel, >= 1, and no other pixel changes: the least squares of the relative differences between measured and
/// resulting irradiance. Where fewer readings than regions leave a choice, regions grow alike. A reading below what the
/// map holds anyhow changes nothing and stays in the residual. Throws Error without measurements or clipped pixels.
Restored restore_clipped(View<const float> latlong, View<const std::uint8_t> clipped,
                         const std::vector<MeasuredIrradiance>& measured);

/// 1 where a channel reaches `level`; by default 98 % of the map's largest sample.
Image<std::uint8_t> clipped_mask(View<const float> latlong, double level = 0);

}  // namespace hdr
