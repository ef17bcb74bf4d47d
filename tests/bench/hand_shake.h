#pragma once
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"

namespace hdr::bench {

/// scene_from_photo of each shot: a turn about the middle and a shift, uniform to the given ends; the middle shot
/// stays.
std::vector<Mat3> hand_shake(Size size, int shots, double shift_px, double turn_degrees, std::uint64_t seed);

/// Distances between the true and the found motion over the picture, sorted.
std::vector<double> motion_distances(const Mat3& truth, const Mat3& found, Size size);

/// Root mean square of the same over the pixels of the photograph that are neither near black nor near white; 0 of
/// none.
double rms_distance_where_usable(const Mat3& truth, const Mat3& found, const Photo& photo);

/// Share of the pixels of 8 bits that are neither near black nor near white.
double usable_share(const Photo& photo);

}  // namespace hdr::bench
