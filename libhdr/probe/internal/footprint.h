#pragma once
// Anti-aliased resampling, apart from which projections are involved.
#include <functional>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/source_picture.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

/// A run of output points (x0 + k step, y) in continuous pixels.
struct PixelRun {
  double x0 = 0, y = 0, step = 1;
  int count = 0;
  Vec2 operator[](int k) const { return {x0 + k * step, y}; }
};

/// Where a run lies in the source picture; kNowhere for points that have no place there.
using SourceFromRun = std::function<void(const PixelRun& run, Vec2* source_px)>;
inline const Vec2 kNowhere = Vec2::Constant(std::numeric_limits<double>::quiet_NaN());
inline bool somewhere(const Vec2& px) {
  return px.x() == px.x();
}

/// The run of a picture in projection `to`, looked up in a picture in projection `from`.
SourceFromRun source_from_run(const Projection& from, const Projection& to, const Mat3& source_from_probe);

struct Averages {
  Image<float> mean;      ///< over the part of the pixel's footprint that the source covers; 0 where that is nothing
  Image<float> coverage;  ///< one channel: that part, 0..1
};

/// Each output pixel is the mean of the source over the pixel's footprint.
Averages average_footprints(const SourcePicture& source, const SourceFromRun& source_from_run, Size size,
                            int max_samples);

}  // namespace hdr::internal
