#include "capture/shoot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

/// Frames are in flight when an exposure is set: wait for the first that was taken with it.
Frame frame_with(Camera& camera, const ExposureSetting& setting, const ShootOptions& options) {
  const Capabilities limits = camera.capabilities();
  const ExposureSetting expected{limits.seconds.snap(setting.seconds), limits.gain.snap(setting.gain)};
  camera.set(setting);
  for (int k = 0; k <= options.max_latency; ++k) {
    const auto exposing =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(expected.seconds));
    Frame frame = camera.next_frame(camera.now() + exposing + options.frame_deadline);
    if (options.on_frame) options.on_frame(frame);
    if (frame.reported && std::abs(std::log(frame.reported->total() / expected.total())) < 0.01) {
      frame.detach();
      frame.exposure = frame.reported;
      frame.verified = Verified::kMetadata;
      return frame;
    }
  }
  throw CameraError(CameraError::Kind::kTimeout,
                    fmt::format("{}: {} s was asked and none of {} frames was taken with it", limits.uri,
                                setting.seconds, options.max_latency + 1));
}

class Running {
 public:
  Running(Camera& camera, const ExposureSetting& first) : camera_(camera) { camera_.start(first); }
  ~Running() { camera_.stop(); }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  Camera& camera_;
};

}  // namespace

Take shoot(Camera& camera, const BracketRequest& request, const ShootOptions& options) {
  Take take;
  for (const double seconds : request.times) take.plan.shots.push_back({{seconds, 1}, "the times were given"});
  if (take.plan.shots.empty()) throw Error("no exposure times; pass --times");
  const Running running(camera, take.plan.shots.front().setting);
  for (const PlannedShot& shot : take.plan.shots) {
    take.frames.push_back(frame_with(camera, shot.setting, options));
    if (options.progress) options.progress(take.frames.size(), take.plan.shots.size());
  }
  return take;
}

}  // namespace hdr
