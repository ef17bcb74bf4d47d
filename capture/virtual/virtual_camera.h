#pragma once
// A camera that photographs a picture of a scene: response/expose.h behind the Camera interface. It runs on any machine
// and knows the truth, so what is tested with it is tested against known light.
#include <cstdint>
#include <deque>

#include "capture/camera.h"
#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/expose.h"

namespace hdr {

struct VirtualCameraOptions {
  Sensor sensor;
  Exposure optics{std::nullopt, 8.0, 100.0, 0};  ///< aperture and ISO of every frame
  double min_seconds = 1e-6, max_seconds = 3600;
  int latency = 0;  ///< frames between set() and the first frame that obeys it
  std::uint64_t seed = 1;
  bool lossy = true;  ///< frames are meant for JPEG
};

/// Relative exposure sensitivity at which the scene's median sample fills `level` of the full well at `exposure`.
double metered_sensitivity(View<const float> scene, const Exposure& exposure, double level);

class VirtualCamera : public Camera {
 public:
  VirtualCamera(std::string uri, Image<float> scene, VirtualCameraOptions options);

  Capabilities capabilities() const override;
  void start() override;
  void set(double seconds) override;
  Frame next_frame(std::chrono::steady_clock::time_point deadline) override;
  void stop() override;

  /// Hand shake: frames from now on show scene pixel scene_from_photo * p (pixel centres at integers).
  void move(const Mat3& scene_from_photo) { scene_from_photo_ = scene_from_photo; }

 private:
  std::string uri_;
  Image<float> scene_;
  VirtualCameraOptions options_;
  Mat3 scene_from_photo_ = Mat3::Identity();
  std::deque<double> pending_;  ///< exposures on their way through the pipeline; the front is the next frame's
  double requested_ = 0;
  std::uint32_t sequence_ = 0;
  bool running_ = false;
};

}  // namespace hdr
