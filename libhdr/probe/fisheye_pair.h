#pragma once
// Two fisheye photographs back to back, each of more than half the sphere, as one.
#include <array>

#include "libhdr/core/radiance.h"
#include "libhdr/probe/projection.h"
#include "libhdr/probe/seam.h"

namespace hdr {

/// One of the pair: its lens, and the axes of its photograph in those of the probe.
struct PairView {
  Fisheye lens;
  Mat3 probe_from_view = Mat3::Identity();
  double gain = 1;  ///< what its radiance is multiplied with to meet the first view's
};

struct FisheyePair {
  std::array<PairView, 2> views;  ///< the first sets the probe's axes
  int matches = 0;                ///< features that both show, of which (or of 1500 of them) the solution was made
  double residual_degrees = 0;    ///< rms angle between the two directions of a match, without the outliers
  double overlap_rms = 0;  ///< of ln(radiance of one / of the other) where both show, after the gain; by the median
                           ///< deviation, since what is near shows from two sides
};

/// Refines a first guess (image circles, field of view, ideal lens; the second looks the other way, within ten degrees
/// or so): SIFT features [Lowe04] of the ring that both show, the rotation on which most of them agree [Fischler81];
/// features are then matched near where that has them, and centres,
/// focal lengths, two coefficients of [Kannala06], the rotation and a direction for each match are fitted to them
/// [Triggs00], with Cauchy's loss against what is near and so shows parallax. The field stays what the guess says, and
/// the disc is where the lens has it. The gain is the median ratio in the ring. Linear pictures of three channels.
/// Error: lenses that do not reach beyond half the sphere, a ring without enough common features, or features that do
/// not meet within .7 degrees.
FisheyePair solve_fisheye_pair(View<const float> front, View<const float> back, const Fisheye& front_guess,
                               const Fisheye& back_guess);

/// A photograph to be merged: linear radiance of three channels, with its standard deviation where that is known.
struct PairPhoto {
  View<const float> rgb, stddev{};
};

struct PairMergeOptions {
  Seam seam = Seam::kFeather;
  double feather_degrees = 1;
};

/// The sphere of both as a lat-long of width x width/2. Between them runs the closed seam around the ring along which
/// they differ least (dynamic programming, as [Davis98] does with Dijkstra's), feathered over `feather_degrees`; or,
/// with Seam::kCut, the seams of a graph cut. `alpha` is 0 where neither shows anything, and empty where they show all;
/// `stddev` is there when both have it, propagated through kernels, gains and weights.
RadianceMap merge_fisheye_pair(const PairPhoto& front, const PairPhoto& back, const FisheyePair& pair, int width,
                               const Mat3& pair_from_probe = Mat3::Identity(), const PairMergeOptions& options = {});

}  // namespace hdr
