#pragma once
// A camera that takes photographs one by one, whatever stands behind it: a device (v4l2/, libcamera/) or a picture of a
// scene (virtual/). It promises nothing about which exposure a frame was taken with: that is what verify.h is for.
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/frame.h"
#include "libhdr/core/error.h"

namespace hdr {

/// What went wrong with a camera, for callers that act on it; what() is the line for the person.
class CameraError : public Error {
 public:
  enum class Kind {
    kDisconnected,  ///< unplugged, or its driver is gone
    kPermission,    ///< the device's file may not be opened
    kBusy,          ///< another program has it
    kNotSupported,  ///< no such camera, no manual exposure, a format that it does not have
    kWrongState,    ///< a call out of order
    kTimeout,       ///< nothing before the deadline
  };
  CameraError(Kind kind, const std::string& what) : Error(what), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

struct Range {
  double min = 0, max = 0;
  double step = 0;  ///< settings are min + k step; 0: any value

  bool contains(double value) const { return value >= min && value <= max; }
  /// The nearest value that the device can be set to.
  double snap(double value) const;
};

struct Capabilities {
  std::string uri, name;
  std::vector<FrameFormat> formats;  ///< best for brackets first: raw, then more bits, then more pixels
  bool manual_exposure = true;
  Range seconds;
  Range gain{1, 1, 0};
  double frame_seconds = 0;             ///< shortest time from frame to frame; a longer exposure lengthens it
  std::optional<double> f_number, iso;  ///< iso: at gain 1
  bool reports_exposure = false;        ///< frames carry Frame::reported
};

struct Configuration {
  std::optional<PixelFormat> pixels;  ///< absent: the first of Capabilities::formats
  std::optional<Size> size;           ///< absent: the largest of that kind
  bool dmabuf = false;                ///< frames with Frame::dmabuf, where the device can; else kNotSupported
};

/// configure() (optional), start(), then set() and next_frame() in turn, then stop(). A call out of order throws
/// CameraError kWrongState. From start() to stop() the device is in manual mode: fixed gain, white balance and focus;
/// stop(), the destructor and SIGINT/SIGTERM give it its old settings back.
class CameraDevice {
 public:
  virtual ~CameraDevice() = default;
  virtual Capabilities capabilities() const = 0;
  /// The format that frames will have. Throws kNotSupported.
  virtual FrameFormat configure(const Configuration& configuration) = 0;
  virtual void start(const ExposureSetting& first) = 0;
  /// Exposure of the frames to come, snapped to what the device can do. Frames on their way show older ones.
  virtual void set(const ExposureSetting& setting) = 0;
  /// The next good frame; those which the driver marks as damaged, and short ones, are dropped here. Throws kTimeout
  /// when there is none before the deadline, kDisconnected when there will be none.
  virtual Frame next_frame(std::chrono::steady_clock::time_point deadline) = 0;
  virtual void stop() = 0;
  /// The clock of deadlines and timestamps. A virtual camera has its own, in which frames take their time and waiting
  /// takes none.
  virtual std::chrono::steady_clock::time_point now() const { return std::chrono::steady_clock::now(); }
};

struct CameraName {
  std::string uri, name;
};

/// The cameras that are connected: V4L2 devices that capture, then libcamera's, then the virtual one, which is always
/// there. A device that cannot be asked is listed with the reason in its name.
std::vector<CameraName> list_cameras();

/// "v4l2:/dev/video0", "libcamera:ID", "virtual:SCENE.exr" or "virtual:" (a scene that is built in). Throws
/// CameraError: kNotSupported names the schemes that are built in.
std::unique_ptr<CameraDevice> open_camera(const std::string& uri);

}  // namespace hdr
