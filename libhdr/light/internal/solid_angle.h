#pragma once
// How much of the sphere a pixel of a projection shows: the Jacobian of dir_from_px.
#include <optional>

#include "libhdr/probe/projection.h"

namespace hdr {

/// Steradians per square pixel at a point inside the picture (not for lat-longs: latlong_pixel_solid_angle is exact).
double solid_angle_density(const Projection& projection, const Vec2& px);

/// The same on the optical axis, where pixels of these projections are square in angle; of a lat-long, on the horizon.
double solid_angle_in_middle(const Projection& projection);

}  // namespace hdr
