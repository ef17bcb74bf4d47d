#pragma once
// Resampling from one projection to another.
#include "libhdr/core/radiance.h"
#include "libhdr/probe/projection.h"

namespace hdr {

/// Picture `to` (of the given size) from picture `source` (projection `from`), where probe direction d shows what
/// `source` has in direction source_from_probe * d. Anti-aliased: each output pixel is an average over its footprint
/// (as many samples as the local minification asks for, at most max_samples an axis), bilinear in the source, wrapping
/// at a lat-long's seam and crossing its poles. Directions that the source does not show are 0. Channels as the source.
Image<float> resample(View<const float> source, const Projection& from, const Projection& to, Size size,
                      const Mat3& source_from_probe = Mat3::Identity(), int max_samples = 16);

/// resample() with the map's tags kept and its projection set to `to`.
RadianceMap unwrap(const RadianceMap& source, const Projection& from, const Projection& to, Size size,
                   const Mat3& source_from_probe = Mat3::Identity());

}  // namespace hdr
