#pragma once
// Resampling from one projection to another.
#include "libhdr/core/radiance.h"
#include "libhdr/probe/projection.h"

namespace hdr {

/// Picture `to` (of the given size) from picture `source` (projection `from`), where probe direction d shows what
/// `source` has in direction source_from_probe * d. Anti-aliased: each output pixel is the mean over its footprint, one
/// sample a source pixel (at most max_samples an axis) and bilinear in the source, wrapping at a lat-long's seam and
/// crossing its poles; where the picture is magnified it is one bilinear sample. A pixel that the source covers partly
/// is the mean over the covered part; what the source does not show is 0. Channels as the source.
Image<float> resample(View<const float> source, const Projection& from, const Projection& to, Size size,
                      const Mat3& source_from_probe = Mat3::Identity(), int max_samples = 64);

/// resample() with the map's tags kept and its projection set to `to`.
RadianceMap unwrap(const RadianceMap& source, const Projection& from, const Projection& to, Size size,
                   const Mat3& source_from_probe = Mat3::Identity());

}  // namespace hdr
