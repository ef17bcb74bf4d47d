#pragma once
// A place to photograph on a machine that has no camera and no radiance map.
#include "libhdr/core/image.h"

namespace hdr {

/// A room with a window and a low sun in it, a lamp, and a mirror ball in the middle of the picture: linear RGB, about
/// 22 stops from the sun to the darkest corner. Made by tracing rays; the same bytes every time. Needs at least 16x16.
Image<float> built_in_scene(Size size);

}  // namespace hdr
