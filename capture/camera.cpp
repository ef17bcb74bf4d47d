#include "capture/camera.h"

#include <fmt/format.h>

#include "capture/virtual/virtual_camera.h"
#include "libhdr/io/read.h"

namespace hdr {
namespace {

/// How a virtual camera is set up when nothing is asked: an 8-bit sRGB camera whose median pixel is well exposed in
/// 1/60 s.
std::unique_ptr<Camera> open_virtual(const std::string& uri, const Path& scene) {
  Image<float> radiance = read_map(scene).map.rgb;
  VirtualCameraOptions options;
  options.sensor.response = srgb_response(8);
  Exposure metered = options.optics;
  metered.seconds = 1.0 / 60;
  options.sensor.sensitivity = metered_sensitivity(radiance, metered, 0.18);
  return std::make_unique<VirtualCamera>(uri, std::move(radiance), std::move(options));
}

}  // namespace

const char* name_of(Verified verified) {
  switch (verified) {
    case Verified::kMetadata:
      return "metadata";
    case Verified::kBrightness:
      return "brightness";
    case Verified::kNone:
      break;
  }
  return "none";
}

std::unique_ptr<Camera> open_camera(const std::string& uri) {
  const std::string scheme = uri.substr(0, uri.find(':'));
  if (scheme == "virtual" && uri.size() > scheme.size() + 1) return open_virtual(uri, uri.substr(scheme.size() + 1));
  throw CameraError(CameraError::Kind::kNotSupported,
                    fmt::format("{}: this build has no such camera; it has virtual:SCENE.exr", uri));
}

}  // namespace hdr
