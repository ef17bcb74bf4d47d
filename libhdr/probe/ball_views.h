#pragma once
// Several photographs of one mirror ball: each shows the whole sphere but for what the ball hides, and each has its
// photographer in the middle. Together they show everything, and nobody.
#include <string>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/radiance.h"
#include "libhdr/probe/projection.h"

namespace hdr {

struct BallView {
  View<const float> rgb;       ///< linear radiance
  MirrorBall ball;             ///< where the ball is in it
  bool outline_known = false;  ///< else ball.disc was found, and is known to about half a pixel
  /// Else ball.distance is a first guess, and without ball.principal the camera looks at the picture's middle.
  bool distance_known = false;
  View<const float> mask{};    ///< one channel, as large as rgb: 1 keeps a pixel, 0 leaves it out; empty keeps all
  View<const float> stddev{};  ///< of rgb; empty: not known
};

struct RegisteredView {
  Mat3 probe_from_view = Mat3::Identity();  ///< the first view's axes are the probe's
  double gain = 1;                          ///< the view's radiance times this is the first view's
  MirrorBall ball;                          ///< as given, or with the distance and the outline that fit best
  double overlap_rms = 0;  ///< of ln(radiance) at 1 degree against the other views, where both see well, robustly
  double correlation = 0;  ///< of detail with the views before, -1..1; 1 for the first
  double runner_up = -1;   ///< the same of the best turn that is another one, by 10 degrees or more
  /// A place that looks alike from two sides: another turn explains nearly as much.
  bool ambiguous() const { return 1 - runner_up < 1.15 * (1 - correlation); }
};

/// How the views are turned against each other, from their pictures alone: rotations are tried all over SO(3) on
/// blurred log radiance, the best are refined from coarse to fine, and at last rotations, gains and unknown distances
/// together, and outlines that were found, under Cauchy's loss. What is near the direction to a camera counts little:
/// there stands its photographer. Error when a view does not fit the others. `names` are for messages, one a view.
std::vector<RegisteredView> register_ball_views(const std::vector<BallView>& views,
                                                const std::vector<std::string>& names);

/// One picture of all views in projection `to`: in each direction a mean with weights that fall towards the rims of the
/// balls and around the directions to the cameras, down to their feet. Where views disagree, the one with the most
/// weight is believed. `alpha` is 0 where no view shows anything, and empty where they show all that `to` has room for;
/// `stddev` is there when all views have it: propagated through kernels, gains and weights, as independent errors.
RadianceMap join_ball_views(const std::vector<BallView>& views, const std::vector<RegisteredView>& registered,
                            const Projection& to, Size size, const Mat3& first_from_probe = Mat3::Identity());

}  // namespace hdr
