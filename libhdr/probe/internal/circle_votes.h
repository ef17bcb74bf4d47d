#pragma once
// The Hough transform for circles [Duda72], [Kimme75]: each edge votes, at every radius, for the two centres that lie
// along its gradient.
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

/// The circles with the most votes for their length, best first, no two alike.
std::vector<Disc> vote_for_circles(View<const float> log_picture, double least_radius, double most_radius, int most);

}  // namespace hdr::internal
