#pragma once
// Cameras behind V4L2, above all USB ones: CameraDevice over the real device.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera.h"
#include "capture/internal/restore_on_signal.h"
#include "capture/v4l2/v4l2_controls.h"
#include "capture/v4l2/v4l2_device.h"
#include "capture/v4l2/v4l2_stream.h"
#include "capture/v4l2/v4l2_uri.h"

namespace hdr {

/// Devices that capture, in the order of their numbers.
std::vector<CameraName> list_v4l2_cameras();

/// "v4l2:/dev/video0", with the options of v4l2_uri.h.
std::unique_ptr<CameraDevice> open_v4l2_camera(const std::string& uri);

class V4l2Camera : public CameraDevice {
 public:
  V4l2Camera(const std::string& uri, const v4l2::Uri& wanted);
  ~V4l2Camera() override { stop(); }

  Capabilities capabilities() const override { return capabilities_; }
  FrameFormat configure(const Configuration& configuration) override;
  void start(const ExposureSetting& first) override;
  void set(const ExposureSetting& setting) override;
  Frame next_frame(std::chrono::steady_clock::time_point deadline) override;
  void stop() override;

 private:
  std::vector<FrameFormat> enumerate_formats(const v4l2::Uri& wanted);
  void describe_exposure();
  void hold_automatics();
  void start_stream();
  v4l2::ControlValues control_values(const ExposureSetting& setting) const;
  std::optional<ExposureSetting> reported(const v4l2::ControlValues& values) const;

  v4l2::Device device_;
  v4l2::Controls controls_;
  Capabilities capabilities_;
  std::uint32_t gain_control_ = 0;  ///< 0: none whose values are known to multiply
  std::optional<int> manual_mode_;  ///< item of the exposure menu
  bool rate_follows_exposure_ = false;

  std::optional<FrameFormat> format_;
  bool dmabuf_ = false;
  double interval_seconds_ = 0;
  ExposureSetting setting_;
  std::optional<v4l2::Stream> stream_;
  std::optional<internal::RestoreOnSignal> restore_on_signal_;
};

}  // namespace hdr
