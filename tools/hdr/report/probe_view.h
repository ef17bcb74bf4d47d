#pragma once
// A light probe on the page: from inside, from outside, and objects that it lights in real time, from its harmonics
// (diffuse), its prefiltered levels (glossy) and itself (mirror), with exposure and glare, as rthdribl had it.
#include <string>

#include "libhdr/core/image.h"
#include "tools/hdr/report/page.h"

namespace hdr::report {

struct ProbeView {
  std::string id;             ///< letters, digits, dashes; once on a page
  View<const float> latlong;  ///< OpenEXR's axes; what is not finite or negative counts as black
  double stops = 0;           ///< the exposure to start with
};

/// The canvas with its controls and data; the page gets the scripts. Browsers without WebGL2 say so in its place.
std::string html_of(const ProbeView& view, Page& page);

}  // namespace hdr::report
