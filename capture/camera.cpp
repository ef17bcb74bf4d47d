#include "capture/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#ifdef HDR_HAS_LIBCAMERA
#include "capture/libcamera/libcamera_camera.h"
#endif
#include "capture/v4l2/v4l2_camera.h"
#include "capture/virtual/virtual_camera.h"

namespace hdr {
namespace {

#ifndef HDR_HAS_LIBCAMERA
std::vector<CameraName> list_libcamera_cameras() {
  return {};
}

std::unique_ptr<CameraDevice> open_libcamera_camera(const std::string& uri) {
  throw CameraError(CameraError::Kind::kNotSupported,
                    uri + ": hdr was built without libcamera; install libcamera-dev and build again, or use v4l2:");
}
#endif

/// A kind of camera. Another one is another row: `list` finds those that are connected, `open` takes a whole URI.
struct Scheme {
  const char* name;
  const char* example;
  std::vector<CameraName> (*list)();
  std::unique_ptr<CameraDevice> (*open)(const std::string& uri);
};

constexpr Scheme kSchemes[] = {
    {"v4l2", "v4l2:/dev/video0", list_v4l2_cameras, open_v4l2_camera},
    {"libcamera", "libcamera:ID", list_libcamera_cameras, open_libcamera_camera},
    {"virtual", "virtual:SCENE.exr", list_virtual_cameras, open_virtual_camera},
};

}  // namespace

double Range::snap(double value) const {
  const double inside = std::clamp(value, min, max);
  if (!(step > 0)) return inside;
  const double last = std::floor((max - min) / step);
  return min + step * std::min(std::round((inside - min) / step), last);
}

std::vector<CameraName> list_cameras() {
  std::vector<CameraName> cameras;
  for (const Scheme& scheme : kSchemes) {
    for (CameraName& camera : scheme.list()) cameras.push_back(std::move(camera));
  }
  return cameras;
}

std::unique_ptr<CameraDevice> open_camera(const std::string& uri) {
  const std::size_t colon = uri.find(':');
  for (const Scheme& scheme : kSchemes) {
    if (colon != std::string::npos && uri.compare(0, colon, scheme.name) == 0) return scheme.open(uri);
  }
  std::string examples;
  for (const Scheme& scheme : kSchemes) {
    if (!examples.empty()) examples += ", ";
    examples += scheme.example;
  }
  throw CameraError(CameraError::Kind::kNotSupported,
                    fmt::format("{}: this build has no such camera; it has {}", uri, examples));
}

}  // namespace hdr
