#pragma once
// A bracket from a camera: one verified frame for each exposure of a plan.
#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "capture/camera.h"
#include "capture/plan.h"

namespace hdr {

struct ShootOptions {
  std::chrono::milliseconds frame_deadline{5000};  ///< for each frame, beyond its exposure
  int max_latency = 8;                             ///< frames that may still show an older exposure
  std::function<void(std::size_t done, std::size_t of)> progress;
  std::function<void(const Frame&)> on_frame;  ///< every frame that arrives, kept or not: a live view
};

/// What a camera gave.
struct Take {
  std::vector<Frame> frames;  ///< detached, each verified, in the order of plan.shots
  Plan plan;
  std::vector<std::string> warnings;  ///< e.g. an exposure that the device could not reach
};

/// Starts the camera (configure() is the caller's, before), takes the bracket that was asked for and stops it, also
/// when something fails. Throws CameraError: kTimeout when no frame can be verified to have an exposure that was asked.
Take shoot(Camera& camera, const BracketRequest& request, const ShootOptions& options = {});

}  // namespace hdr
