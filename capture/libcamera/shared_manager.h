#pragma once
// libcamera's manager, of which a process may have one at a time.
#include <libcamera/libcamera.h>

#include <memory>

namespace hdr::lc {

/// The one that runs, made for the first camera and gone with the last, so that its threads have ended before the
/// program's static objects do. Throws CameraError: the last one does not end, or libcamera does not start.
std::shared_ptr<libcamera::CameraManager> shared_manager();

/// Called on libcamera's own thread when a camera is gone that has requests on their way: returns when the manager has
/// been told to end, or after 3 s, when other cameras keep it. libcamera (0.0.3 at least) aborts the program when it
/// comes upon one of those requests: it fails, which completes it, which no camera that is gone may do
/// (Camera::requestComplete). A manager that ends forgets them.
void hold_until_manager_ends();

}  // namespace hdr::lc
