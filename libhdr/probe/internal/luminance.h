#pragma once
// Pictures of luminance, and smaller ones of them, for searches.
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

/// Luminance of RGB (one or two channels: the first). NaN and negative values become 0, infinity a large number.
Image<float> luminance_of(View<const float> picture);

/// One channel, its values bounded likewise.
Image<float> channel_of(View<const float> picture, int channel);

/// Half the size: each pixel the mean of four; an odd last row or column is left out.
Image<float> halved(View<const float> picture);

/// The picture, its half, its quarter ... until the longer side is at most `longest`, as long as the shorter one stays
/// at least `shortest`.
std::vector<Image<float>> halvings(Image<float> picture, int longest, int shortest);

/// The picture's first channel at continuous pixel coordinates; outside the frame its border.
double bilinear(View<const float> picture, const Vec2& px);

}  // namespace hdr::internal
