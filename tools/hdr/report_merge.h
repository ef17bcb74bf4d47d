#pragma once
// The merged map in a report: what the shots cover, how they were registered, and the map itself.
#include <string>

#include "tools/hdr/map_digest.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/report_common.h"

namespace hdr::tools {

/// Shifts of the shots and what is left of them.
void add_alignment(report::Page& page, const Bracket& bracket, const Alignment& alignment);

/// All that a merge can tell: warnings, the map (with `drawing` over it, SVG in its pixels), coverage, shots,
/// registration, response. Stages come last, by who writes the page.
void add_merge(report::Page& page, const Run& run, const MergeInputs& inputs, const MergeSummary& merged,
               const MapDigest& digest, const std::string& drawing = {});

}  // namespace hdr::tools
