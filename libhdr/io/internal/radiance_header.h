#pragma once
#include "libhdr/core/photo.h"

namespace hdr::internal {

/// The product of the EXPOSURE lines of a Radiance (.hdr) file, by which its pixels are to be divided [Ward91];
/// OpenImageIO 2.4 reports the last line alone and divides by none. 1 when there is none.
double radiance_exposure(const Path& path);

}  // namespace hdr::internal
