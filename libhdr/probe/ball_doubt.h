#pragma once
// What a ball's directions are off by when its distance is not known.
#include "libhdr/probe/projection.h"

namespace hdr {

/// How far apart two balls with one outline show their directions at most, degrees, within .98 of the radius.
double most_degrees_between(const MirrorBall& a, const MirrorBall& b);

}  // namespace hdr
