#pragma once
// How two maps of the sphere are turned against each other, without a first guess.
#include <vector>

#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/ball_sphere.h"

namespace hdr::internal {

struct RotationMatch {
  Mat3 a_from_b = Mat3::Identity();
  double distance_a = 0, distance_b = 0;  ///< of the cameras, radii: given, or the best of a few that were tried
  double correlation = -1;                ///< of detail, weighted, at about 2 degrees
};

/// The rotations under which two views agree best, none near a better one, and roughly the distances that are not
/// known; the best first, one at least. Rooms with two ends alike have two that only a closer look tells apart.
std::vector<RotationMatch> match_rotations(const BallView& a, const BallView& b);

}  // namespace hdr::internal
