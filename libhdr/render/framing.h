#pragma once
// Where a camera must stand to see all of a scene.
#include "libhdr/render/scene.h"

namespace hdr {

/// Looks at the scene from the front, a little to the right and above, from as near as every vertex in the picture
/// allows, with a margin of 4 % of the picture around. `aspect` is width by height. A scene of one point is seen from
/// one unit away. Throws Error when there are no vertices, or when `fov_degrees` is not between 0 and 180.
Camera framing_camera(const Scene& scene, double aspect, double fov_degrees = 40);

/// The middle of the box around all vertices.
Vec3f middle_of(const Scene& scene);

}  // namespace hdr
