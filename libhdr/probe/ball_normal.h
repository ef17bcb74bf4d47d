#pragma once
#include <optional>

#include "libhdr/probe/projection.h"

namespace hdr {

/// The normal of a ball where a pixel shows it, in the axes of MirrorBall::dir_from_px; nullopt outside the outline.
std::optional<Vec3> normal_from_px(const MirrorBall& ball, const Vec2& px);

}  // namespace hdr
