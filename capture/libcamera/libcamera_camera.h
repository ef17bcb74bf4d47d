#pragma once
// Cameras behind libcamera, 0.0.3 and later: those with a bare sensor and an image processor that Linux drives, and USB
// cameras too.
#include <memory>
#include <string>
#include <vector>

#include "capture/camera.h"

namespace hdr {

std::vector<CameraName> list_libcamera_cameras();

/// "libcamera:ID" as they are listed, or "libcamera:" for the first. Options as in v4l2/v4l2_uri.h: format=, size= and
/// black= (where the camera does not tell).
std::unique_ptr<CameraDevice> open_libcamera_camera(const std::string& uri);

}  // namespace hdr
