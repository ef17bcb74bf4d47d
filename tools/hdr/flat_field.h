#pragma once
#include <string>

#include "libhdr/core/image.h"
#include "libhdr/response/response.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// What a uniform scene gave, linear: a radiance map as it is, a photograph through `response`. Empty without a path.
/// Throws Error when its size is not `size`, or when a pixel of it has no light to divide by.
Image<float> read_flat_field(Run& run, const std::string& path, const Response& response, Size size);

}  // namespace hdr::tools
