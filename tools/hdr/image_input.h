#pragma once
// Pictures for the verbs that work on HDR and LDR alike: linear light in, and out in the format of the output's name.
#include <string>

#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// Reads a map or a picture; warnings go to the run.
RadianceMap read_image(Run& run, const std::string& path, const ReadMapOptions& options = {});

/// Maps by write_map; .png and .jpg as sRGB codes, what is beyond [0,1] clipped, with a warning that counts it.
void write_image(Run& run, const std::string& path, const RadianceMap& map, const Provenance& provenance,
                 const WriteOptions& options);

}  // namespace hdr::tools
