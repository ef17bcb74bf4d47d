#pragma once
// From a picture to a probe, for `unwrap` and `probe`: which projection the picture has, finding the ball, resampling.
#include "libhdr/core/radiance.h"
#include "tools/hdr/options.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// Where the ball is in a picture: by --from or the picture's own tag, else --ball or the search.
struct BallGeometry {
  MirrorBall ball;
  bool outline_known = false;   ///< it was given, not found
  bool distance_known = false;  ///< it was given, not taken for far or read from the outline
  /// What directions may be off by at most, degrees, within .98 of the radius, where nothing says the distance: a camera
  /// taken for far may be at 5 radii.
  double direction_doubt_degrees = 0;
};
BallGeometry ball_geometry(Run& run, const RadianceMap& picture, const UnwrapFlags& flags, const std::string& source);

/// `default_from` counts when neither --from nor the picture's hdr:projection says what it is ("" : 2:1 is lat-long).
/// `source` is the picture's name for messages. Fills the answer's ball, views and projection.
RadianceMap unwrap_picture(Run& run, const RadianceMap& picture, const UnwrapFlags& flags,
                           const std::string& default_from, const std::string& source);

}  // namespace hdr::tools
