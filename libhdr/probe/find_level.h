#pragma once
// Which way is up in a picture of the whole sphere, or of a part of it.
#include <optional>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

struct FoundLevel {
  Mat3 level_from_picture = Mat3::Identity();  ///< the shortest turn that brings what is vertical to +Y
  double tilt_degrees = 0;                     ///< of that turn
  double support = 0;  ///< share of the lines' length that is vertical, beyond what lines without order would have
  double deviation_degrees = 0;  ///< of the zenith that was found, if each line errs for itself
};

/// From straight lines (probe/internal/sphere_lines.h): what is vertical in the place (walls, poles, trunks) lies on
/// great circles through its zenith, wherever it is seen. The zenith within 40 degrees of +Y that most of the lines'
/// length in a lat-long (the axes of core/sphere.h, one or three channels of light) agrees on; `shown`, where it is
/// given, is 0 where the picture shows nothing. nullopt where no zenith stands out: meadows, clouds.
std::optional<FoundLevel> find_level(View<const float> latlong, View<const float> shown = {});

/// From directions that lie on the true horizon, two or more: the turn that brings them to elevation 0. Error where
/// they do not tell: all of them in one direction or its opposite, or a horizon steeper than 60 degrees.
Mat3 level_from_horizon(const std::vector<Vec3>& on_horizon);

}  // namespace hdr
