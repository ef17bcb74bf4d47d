#pragma once
// A camera that photographs a picture of a scene: response/expose.h behind the CameraDevice interface. It runs on any
// machine and knows the truth, so what is tested with it is tested against known light. It has its own time: frames
// take as long as a sensor's would, by CameraDevice::now(), and nobody waits. And it has the faults of real devices.
#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "capture/camera.h"
#include "libhdr/core/image.h"
#include "libhdr/response/expose.h"

namespace hdr {

/// What can go wrong. Shares are probabilities for each frame; counts are of frames or set() calls since start().
struct VirtualFaults {
  static constexpr int kNever = std::numeric_limits<int>::max();

  double dropped = 0;       ///< share of frames that never arrive: a gap in the sequence
  double damaged = 0;       ///< share of frames that the driver marks as bad; they are dropped: a gap, too
  double cut = 0;           ///< share of frames with too few bytes, not marked
  double torn = 0;          ///< share of frames whose lower part is the frame before, not marked
  int unplug = kNever;      ///< the frame that never comes because the device is gone: kDisconnected
  int freeze = kNever;      ///< the frame from which on nothing arrives any more: kTimeout
  int stall = kNever;       ///< the set() that the device does not answer: kTimeout
  int stuck = kNever;       ///< the set() from which on the device says yes and changes nothing
  bool busy = false;        ///< start() finds another program: kBusy
  bool permission = false;  ///< configure() and start() are refused: kPermission
  bool no_manual = false;   ///< manual exposure is not offered: start() says kNotSupported
  bool automatic = false;   ///< manual exposure is offered, and the device meters on all the same
  double clamp_seconds =
      std::numeric_limits<double>::infinity();  ///< longer exposures are this one, and nothing says so
};

struct VirtualCameraOptions {
  std::vector<PixelFormat> formats{PixelFormat::kRgb8};  ///< the first is the default
  Cfa cfa = Cfa::kRggb;                                  ///< of Bayer formats
  std::string response = "srgb";  ///< a name as response_from_name knows it; Bayer formats are linear
  NoiseModel noise;               ///< at gain 1
  double sensitivity = 0;         ///< as Sensor::sensitivity; 0: 1/60 s puts the scene's median at `level` of full well
  double level = 0.18;
  Exposure optics{std::nullopt, 8.0, 100.0, 0};  ///< aperture, and ISO at gain 1, of every frame
  Range seconds{1.0 / 32000, 30, 0};
  Range gain{1, 1, 0};
  double frame_seconds = 1.0 / 30;
  int latency = 2;                             ///< frames after set() that still show the older exposure
  bool metadata = true;                        ///< frames carry Frame::reported, which is the truth
  double flicker_hz = 0, flicker_depth = 0.3;  ///< the light goes up and down by this share, so many times a second
  bool realtime = false;                       ///< frames come at their time: for a live view
  std::uint64_t seed = 1;
  VirtualFaults faults;
};

/// Relative exposure sensitivity at which the scene's median sample fills `level` of the full well at `exposure`.
double metered_sensitivity(View<const float> scene, const Exposure& exposure, double level);

class VirtualCamera : public CameraDevice {
 public:
  /// `scene`: linear RGB, width x height x 3. Throws Error for options that no camera has.
  VirtualCamera(std::string uri, Image<float> scene, VirtualCameraOptions options);

  Capabilities capabilities() const override;
  FrameFormat configure(const Configuration& configuration) override;
  void start(const ExposureSetting& first) override;
  void set(const ExposureSetting& setting) override;
  Frame next_frame(std::chrono::steady_clock::time_point deadline) override;
  void stop() override;
  std::chrono::steady_clock::time_point now() const override { return now_; }

  /// The truth about the frame that next_frame() gave last, for tests.
  ExposureSetting true_exposure() const { return last_exposure_; }

 private:
  FrameFormat format_of(PixelFormat pixels) const;
  ExposureSetting device_setting(const ExposureSetting& asked) const;
  std::vector<std::uint8_t> photograph(const ExposureSetting& exposure, double start_seconds) const;
  void meter(const ExposureSetting& exposure);
  bool strikes(double share, std::uint64_t fault) const;

  std::string uri_;
  Image<float> scene_;
  VirtualCameraOptions options_;
  FrameFormat format_;
  std::deque<ExposureSetting> pending_;  ///< settings on their way to the sensor; the front is the next frame's
  ExposureSetting requested_, device_, automatic_, last_exposure_;
  double median_ = 0;  ///< of the scene's samples
  std::vector<std::uint8_t> before_;
  std::chrono::steady_clock::time_point now_{std::chrono::seconds(1)};
  std::chrono::steady_clock::time_point exposing_since_{};
  std::chrono::steady_clock::time_point real_start_{};
  std::uint32_t sequence_ = 0;
  int sets_ = 0;
  bool running_ = false;
};

/// Opens "virtual:SCENE.exr?OPTIONS", see virtual_uri.h. Throws CameraError, and Error for a scene that cannot be read.
std::unique_ptr<CameraDevice> open_virtual_camera(const std::string& uri);
std::vector<CameraName> list_virtual_cameras();

}  // namespace hdr
