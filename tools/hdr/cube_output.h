#pragma once
// A cube map on the disk: a folder of six faces, px.exr to nz.exr.
#include <array>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"
#include "libhdr/core/radiance.h"
#include "libhdr/io/write.h"

namespace hdr::tools {

/// Makes the folder where it is missing. `like` lends its chromaticities and unit.
void write_cube(const Path& folder, std::array<Image<float>, 6> faces, const RadianceMap& like,
                const Provenance& provenance, const WriteOptions& options);

}  // namespace hdr::tools
