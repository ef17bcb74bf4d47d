#pragma once
// From several photographs of one mirror ball to one sphere.
#include "libhdr/core/radiance.h"
#include "tools/hdr/options.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// Reads the pictures, finds their balls, registers them and joins them. `masks`: a picture for each, white keeps; "-"
/// or nothing at all keeps everything. Fills the answer's balls, views and projection.
RadianceMap unwrap_ball_views(Run& run, const std::vector<std::string>& images, const std::vector<std::string>& masks,
                              const UnwrapFlags& flags);

}  // namespace hdr::tools
