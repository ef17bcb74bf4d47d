#pragma once
// Which way round others store the sphere. Directions are always those of core/sphere.h; a convention says where in the
// picture they lie. Facts, from the programs' sources and documentation:
//
//   openexr     OpenEXR's ImfEnvmap.h, USD's DomeLight, Mitsuba 3's envmap (u = atan2(x, -z) / 2 pi): the centre of a
//               lat-long is +Z, +X to its left. Cube faces by ImfEnvmap.cpp.
//   blender     Cycles' projection.h: u = 1/2 - atan2(y, x) / 2 pi, +Z up: the centre is Blender's +X, its +Y to the
//               left. Blender's (x, y, z) is our (x, z, -y), as its glTF import has it: the centre is our +X.
//   threejs     three.js's equirectUv and the glTF sample viewer: u = 1/2 + atan2(z, x) / 2 pi: the centre is +X, +Z to
//               its right. Cube faces are looked up along (-x, y, z), three.js's flipEnvMap.
//   pbrt        pbrt-v3: u = atan2(y, x) / 2 pi from the left edge, +Z up, in left-handed axes: pbrt's (x, y, z) is our
//               (x, z, y), so the centre is -X, +Z to its left. pbrt-v4: the equal-area octahedral map in those axes.
//   alicevision AliceVision's sphericalMapping: (x, y, z) = (cos a sin b, sin a, cos a cos b), y down, b from -pi at
//   the
//               left edge: its (x, y, z) is our (-x, -y, z), and the picture is the same as OpenEXR's.
//   hdrtoolbox  Banterle's LL2Direction: phi = pi (2 u - 1) - pi / 2, x = cos phi, z = sin phi: the centre is -Z, +X to
//               its right.
//   opengl      The face table of the OpenGL specification (cube maps only), looked up along our direction itself: seen
//               from inside, faces are mirrored.
#include <optional>
#include <string>

#include "libhdr/core/vec.h"

namespace hdr {

enum class Convention { kOpenExr, kBlender, kThreeJs, kPbrt, kAliceVision, kHdrToolbox, kOpenGl };

/// "openexr" and so on; the inverse also knows "usd", "mitsuba" (openexr) and "gltf" (threejs).
const char* name_of(Convention convention);
std::optional<Convention> convention_from_name(const std::string& name);

/// The rotation that takes a direction to where an OpenEXR lat-long would show what a lat-long of this convention shows
/// in that place. OpenGL has no lat-long: the identity.
Mat3 openexr_from_convention(Convention convention);

}  // namespace hdr
