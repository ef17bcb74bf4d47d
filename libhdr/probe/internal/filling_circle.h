#pragma once
// The ball of a picture that was cropped around it: a second way to find it, where the mirror's own evidence is lost to
// blur and compression.
#include <optional>

#include "libhdr/core/image.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

struct FillingCircle {
  Disc disc;
  double support = 0;      ///< share of the outline, as far as the picture shows it, on which an edge lies
  double residual_px = 0;  ///< rms distance of those edges from the circle
};

/// A circle that nearly fills the frame and along which edges run, in a picture of luminance above 0. It is as sure as
/// the blur of the edges; nullopt where the edges are no more than a photograph of anything has.
std::optional<FillingCircle> find_filling_circle(View<const float> luminance);

}  // namespace hdr::internal
