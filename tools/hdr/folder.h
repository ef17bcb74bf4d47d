#pragma once
// A folder for results.
#include "libhdr/core/photo.h"

namespace hdr::tools {

/// Makes the folder, and those above it, where missing. Throws Error.
void make_folder(const Path& folder);

}  // namespace hdr::tools
