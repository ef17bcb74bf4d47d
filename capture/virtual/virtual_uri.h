#pragma once
// Virtual cameras by name: "virtual:SCENE?OPTIONS". SCENE is a radiance map, nothing is a room that is built in.
// OPTIONS are NAME=VALUE, joined by &:
//   format=rgb8,...      grey8 grey10 grey12 grey16 rgb8 rgb16 yuyv mjpeg bayer8 bayer10 bayer12 bayer16 bayer10p
//   bayer12p cfa=rggb             rggb bggr grbg gbrg response=srgb        srgb linear gamma:2.2 film; Bayer formats
//   are linear size=640x480         of the built-in room seconds=1/32000..30  the shortest and the longest exposure;
//   with :STEP, in steps of that gain=1..1            likewise fps=30  latency=2  metadata=1  level=.18 full_well=30000
//   read_noise=5  seed=1  realtime=0 flicker=100:.3       lamps: times a second, and share faults=... dropped:SHARE
//   damaged:SHARE cut:SHARE torn:SHARE unplug:FRAME freeze:FRAME stall:CALL stuck:CALL
//                        clamp:SECONDS busy permission no-manual automatic, joined by commas (VirtualFaults)
// "virtual:room.exr?latency=4&metadata=0&faults=dropped:.1,unplug:20"
#include <string>

#include "capture/virtual/virtual_camera.h"

namespace hdr {

struct VirtualUri {
  std::string scene;  ///< empty: the built-in one
  Size size{640, 480};
  VirtualCameraOptions options;
};

/// Throws CameraError kNotSupported, naming what is wrong.
VirtualUri parse_virtual_uri(const std::string& uri);

}  // namespace hdr
