#pragma once
// The ring around the first lens's axis that two opposite lenses both see, unrolled: columns are azimuths from image
// right (-X) towards +Y, rows are angles from the axis, growing downwards.
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/probe/fisheye_pair.h"

namespace hdr::internal {

struct Ring {
  int width = 0, height = 0;
  double first_angle = 0, last_angle = 0;  ///< radians from the first view's axis: above the first row, below the last

  Vec3 dir_at(double column, double row) const;  ///< continuous pixels
  Vec2 px_of(const Vec3& dir) const;
  double angle_of_row(double row) const { return first_angle + (last_angle - first_angle) * row / height; }
};

/// Throws Error when two lenses, back to back, leave a gap between them.
void require_overlap(const Fisheye& front, const Fisheye& back);

/// The ring that both see, `pixels_per_radian` fine around, with a margin in radians on either side; empty (height 0)
/// where there is none.
Ring ring_of(const PairView& front, const PairView& back, double pixels_per_radian, double margin = 0);

/// What a view shows on the ring, bilinear, `view.gain` applied; NaN in all channels where it shows nothing.
Image<float> unroll(View<const float> photograph, const PairView& view, const Ring& ring);

/// The same direction as two photographs show it, continuous pixels.
struct Match {
  Vec2 front, back;
  Vec3 dir;  ///< in between, in the axes of the guess
};

/// Features of both unrolled rings that look alike and lie within `reach` radians of each other.
std::vector<Match> match_rings(View<const float> front, View<const float> back, const Ring& ring, const PairView& a,
                               const PairView& b, double reach);

/// Fits lenses and rotation to the matches. Returns rms angle of the inliers, radians.
double fit_pair(const std::vector<Match>& matches, FisheyePair& pair);

/// For each column the row of the seam.
std::vector<double> best_seam(View<const float> front, View<const float> back);

}  // namespace hdr::internal
