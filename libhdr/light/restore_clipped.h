#pragma once
// The missing light of clipped suns, from irradiance that was measured beside the probe.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// What a surface received, in the map's unit times steradians: a lux meter lying there faces +Y; a diffuse ball has
/// one such reading at every normal that was photographed (diffuse_ball.h).
struct MeasuredIrradiance {
  Vec3 normal = Vec3::UnitY();
  Rgb irradiance = Rgb::Zero();
};

struct Restored {
  Image<float> rgb;
  int regions = 0;              ///< connected clipped regions on the sphere
  std::vector<Rgb> gains;       ///< by which each region's pixels were multiplied, at least 1
  std::vector<Rgb> deviations;  ///< of the gains, if what is left in the readings is noise; 0 of those at 1
  Rgb residual = Rgb::Zero();   ///< rms over the measurements of what is still missing, relative to what was measured
  double scale = 1;             ///< by which the readings were multiplied
  double scale_deviation = 0;
};

struct RestoreOptions {
  /// Readings are known but for one factor, as those of a grey ball of unknown albedo: it is solved for too, which
  /// takes normals that the suns do not reach.
  bool unknown_scale = false;
};

/// A lat-long; pixels in which `clipped` (one channel, same size) is not 0 are multiplied by one number a region and
/// channel, >= 1, and no other pixel changes: the least squares of the relative differences between measured and
/// resulting irradiance. Where fewer readings than regions leave a choice, regions grow alike, and so do all beyond
/// the 48 that hold most light. A reading below what the map holds anyhow changes nothing and stays in the residual.
/// Throws Error without measurements or clipped pixels.
Restored restore_clipped(View<const float> latlong, View<const std::uint8_t> clipped,
                         const std::vector<MeasuredIrradiance>& measured, const RestoreOptions& options = {});

/// 1 where a channel reaches `level`; by default 98 % of the map's largest sample.
Image<std::uint8_t> clipped_mask(View<const float> latlong, double level = 0);

}  // namespace hdr
