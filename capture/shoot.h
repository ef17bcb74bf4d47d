#pragma once
// A bracket from a camera: which exposures (plan.h), each taken and verified (verify.h).
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

/// What a camera gave. Every frame is verified: an exposure that could not be is left out, with a warning.
struct Take {
  std::vector<Frame> frames;  ///< detached, in the order of plan.shots
  Plan plan;
  std::vector<std::string> warnings;  ///< e.g. "0.5 s was asked and the picture looks like 0.033 s; left out"
  int latency = 0;                    ///< frames from set() to the first that obeys
  double prepare_seconds = 0;         ///< for latency and response, once for a device: by the camera's clock
  double probe_seconds = 0;           ///< for the ends of the scene, where the plan needs them
  double bracket_seconds = 0;         ///< for those shots that were not there already
  std::size_t taken = 0;              ///< shots that were not there already
};

/// Starts the camera (configure() is the caller's, before), takes the bracket that was asked for and stops it, also
/// when something fails. Throws CameraError: kNotSupported when the picture does not follow the exposure, kTimeout when
/// no frame can be verified, and what the camera throws.
Take shoot(CameraDevice& camera, const BracketRequest& request, const ShootOptions& options = {});

}  // namespace hdr
