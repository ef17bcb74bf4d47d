#include "capture/internal/order_of_calls.h"

namespace hdr::internal {

using Kind = CameraError::Kind;

void require_configurable(const std::string& uri, bool running) {
  if (running) throw CameraError(Kind::kWrongState, uri + ": its format cannot change while it runs; stop it");
}

void require_startable(const Capabilities& camera, bool running) {
  if (running) throw CameraError(Kind::kWrongState, camera.uri + ": it runs already; stop it");
  if (camera.manual_exposure) return;
  throw CameraError(Kind::kNotSupported,
                    camera.uri + ": the camera has no manual exposure, so it cannot take a bracket; use another");
}

void require_running(const std::string& uri, bool running) {
  if (!running) throw CameraError(Kind::kWrongState, uri + ": it does not run; start it");
}

}  // namespace hdr::internal
