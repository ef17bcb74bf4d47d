#pragma once
// Exposure in libcamera's terms: which controls a camera has, and lists of them for an exposure.
#include <libcamera/libcamera.h>

#include <optional>

#include "capture/camera.h"

namespace hdr::lc {

/// Exposure range, gain range, frame time and whether frames report them, into `capabilities`.
void describe_exposure(const libcamera::Camera& camera, Capabilities& capabilities);

/// Manual exposure with this setting; on the way, fixed white balance and focus.
libcamera::ControlList manual(const libcamera::Camera& camera, const Capabilities& capabilities,
                              const ExposureSetting& setting);
/// Automatic modes again, those that the camera has.
libcamera::ControlList automatic(const libcamera::Camera& camera);

/// What the frame's metadata say. Absent without an exposure time.
std::optional<ExposureSetting> reported(const libcamera::ControlList& metadata);
/// The black level that they say, for samples of `bits`.
std::optional<double> black_level(const libcamera::ControlList& metadata, int bits);

}  // namespace hdr::lc
