#pragma once
// A camera's frame as a photograph.
#include <optional>

#include "capture/frame.h"
#include "libhdr/core/photo.h"

namespace hdr {

struct DevelopOptions {
  std::optional<double> f_number, iso;  ///< of the camera; iso at gain 1
};

/// The frame's codes as RGB, with the exposure that it was verified to have, else the one that was asked. Throws Error
/// for bytes that are not what the format says.
Photo develop(const Frame& frame, const DevelopOptions& options = {});

}  // namespace hdr
