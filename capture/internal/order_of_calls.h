#pragma once
// The calls that CameraDevice refuses (camera.h), said alike by every camera.
#include "capture/camera.h"

namespace hdr::internal {

/// configure() of a camera that runs: CameraError kWrongState.
void require_configurable(const std::string& uri, bool running);

/// start() of a camera that runs: kWrongState; of one whose exposure cannot be set: kNotSupported.
void require_startable(const Capabilities& camera, bool running);

/// set() and next_frame() of a camera that does not run: kWrongState.
void require_running(const std::string& uri, bool running);

}  // namespace hdr::internal
