#pragma once
// The response in a report: its curve with its doubt, and the data behind it.
#include "libhdr/align/align.h"
#include "libhdr/response/calibrate.h"
#include "tools/hdr/report_common.h"

namespace hdr::tools {

/// `fit` is none when the response was given. Reads pixels of the shots again.
void add_response(report::Page& page, const Bracket& bracket, const Alignment& alignment, const Response& response,
                  const Calibration* fit);

/// Labels against refined times, from the answer's `exposures`; nothing where they are the same.
void add_exposures(report::Page& page, const Json& exposures);

}  // namespace hdr::tools
