#pragma once
// A bracket from a camera: one verified frame for each asked time.
#include <chrono>
#include <functional>
#include <vector>

#include "capture/camera.h"

namespace hdr {

struct ShootOptions {
  std::chrono::milliseconds frame_deadline{5000};  ///< beyond the exposure itself
  int max_latency = 8;                             ///< frames that may still show an older exposure
  std::function<void(std::size_t done)> progress;
};

/// Starts the camera, takes one frame for each time and stops it, also when something fails. A frame is kept when the
/// camera reports the time that was asked, or its own limit. Throws CameraError kTimeout when none of max_latency + 1
/// frames does.
std::vector<Frame> shoot(Camera& camera, const std::vector<double>& times, const ShootOptions& options = {});

}  // namespace hdr
