#include "capture/virtual/virtual_camera.h"
#include "libhdr/io/read.h"

namespace hdr {

std::unique_ptr<Camera> open_virtual_camera(const std::string& uri) {
  const std::string scene = uri.substr(uri.find(':') + 1);
  return std::make_unique<VirtualCamera>(uri, read_map(scene).map.rgb, VirtualCameraOptions{});
}

std::vector<CameraName> list_virtual_cameras() {
  return {{"virtual:", "virtual camera in a room that is built in"}};
}

}  // namespace hdr
