#pragma once
// A camera that takes photographs one by one, whatever stands behind it (a device, or a picture of a scene).
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/photo.h"

namespace hdr {

/// What went wrong with a camera, for callers that act on it; what() is the line for the person.
class CameraError : public Error {
 public:
  enum class Kind { kDisconnected, kPermission, kBusy, kNotSupported, kWrongState, kTimeout };
  CameraError(Kind kind, const std::string& what) : Error(what), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

struct Capabilities {
  std::string uri, name;
  std::vector<std::string> formats;
  double min_seconds = 0, max_seconds = 0;
};

enum class Verified { kNone, kBrightness, kMetadata };
const char* name_of(Verified verified);

struct Frame {
  Photo photo;  ///< its exposure is the one that was used
  double requested_seconds = 0;
  std::optional<double> reported_seconds;
  Verified verified = Verified::kNone;
  std::uint32_t sequence = 0;
  std::chrono::nanoseconds timestamp{};
};

/// start(), then set() and next_frame() in turn, then stop(). A call out of order throws CameraError kWrongState.
class Camera {
 public:
  virtual ~Camera() = default;
  virtual Capabilities capabilities() const = 0;
  virtual void start() = 0;
  /// Exposure of the frames to come; they may lag, so look at each frame's own exposure.
  virtual void set(double seconds) = 0;
  virtual Frame next_frame(std::chrono::steady_clock::time_point deadline) = 0;
  virtual void stop() = 0;
};

/// "virtual:SCENE.exr". Other schemes throw CameraError kNotSupported that names those which are built in.
std::unique_ptr<Camera> open_camera(const std::string& uri);

}  // namespace hdr
