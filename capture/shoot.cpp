#include "capture/shoot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

/// Frames are in flight when an exposure is set: wait for the first that was taken with it.
Frame frame_with(Camera& camera, double seconds, const ShootOptions& options) {
  const Capabilities limits = camera.capabilities();
  const double expected = std::clamp(seconds, limits.min_seconds, limits.max_seconds);
  camera.set(seconds);
  for (int k = 0; k <= options.max_latency; ++k) {
    const auto exposing =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(expected));
    Frame frame = camera.next_frame(std::chrono::steady_clock::now() + exposing + options.frame_deadline);
    if (frame.reported_seconds && std::abs(std::log(*frame.reported_seconds / expected)) < 0.01) return frame;
  }
  throw CameraError(CameraError::Kind::kTimeout,
                    fmt::format("{}: {} s was asked and none of {} frames was taken with it", limits.uri, seconds,
                                options.max_latency + 1));
}

struct Running {
  Camera& camera;
  explicit Running(Camera& c) : camera(c) { camera.start(); }
  ~Running() { camera.stop(); }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
};

}  // namespace

std::vector<Frame> shoot(Camera& camera, const std::vector<double>& times, const ShootOptions& options) {
  const Running running(camera);
  std::vector<Frame> frames;
  for (const double seconds : times) {
    frames.push_back(frame_with(camera, seconds, options));
    if (options.progress) options.progress(frames.size());
  }
  return frames;
}

}  // namespace hdr
