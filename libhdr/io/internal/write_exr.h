#pragma once
#include "libhdr/io/write.h"

namespace hdr::internal {

/// Writes `map` as OpenEXR into `file`, a temporary of `path`, the name for messages. Throws Error.
void write_exr(const Path& file, const Path& path, const RadianceMap& map, const Provenance& provenance,
               const WriteOptions& options);

}  // namespace hdr::internal
