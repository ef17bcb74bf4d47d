#pragma once
// What reports show of light: a finished probe, and a render.
#include "libhdr/core/radiance.h"
#include "libhdr/render/render.h"
#include "tools/hdr/report_common.h"

namespace hdr::tools {

/// The probe to turn and to light objects with; `probe` says its projection.
void add_probe(report::Page& page, const RadianceMap& probe);

/// Where the ball was found and how sure that is; nothing when the answer names none.
void add_ball(report::Page& page, const Json& answer);

/// The ball that the answer names, drawn in the photograph's pixels; empty when there is none.
std::string drawing_of_ball(const Json& answer);

/// The whole report of `render`.
void write_render_report(const ReportFlag& flag, const Run& run, const Rendering& result);

}  // namespace hdr::tools
