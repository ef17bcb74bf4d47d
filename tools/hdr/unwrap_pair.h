#pragma once
// Two opposite fisheyes to one sphere, for `unwrap`.
#include <string>
#include <vector>

#include "libhdr/core/radiance.h"
#include "tools/hdr/options.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// Whether two pictures are to be read as a pair: --from fisheye, or both say so themselves.
bool are_fisheye_pair(const std::vector<const RadianceMap*>& pictures, const UnwrapFlags& flags);

/// The first picture sets the probe's axes. Fills the answer's circle, views, matches and projection.
RadianceMap unwrap_fisheye_pair(Run& run, const RadianceMap& front, const RadianceMap& back, const UnwrapFlags& flags,
                                const std::vector<std::string>& names);

}  // namespace hdr::tools
