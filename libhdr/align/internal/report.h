#pragma once
// From places to rows: what is decided about each shot, and how it is said.
#include <vector>

#include "libhdr/align/align.h"
#include "libhdr/align/internal/joint.h"

namespace hdr::internal {

/// No shot is so far from the reference that resampling would mend more than it blurs.
bool all_still(const MotionFrame& frame, const std::vector<Place>& places);

/// The row of a shot that has a place. `bracket_still`: all of them keep the identity.
FrameAlignment decided(const MotionFrame& frame, const Place& place, bool bracket_still);

/// Rows of the shots that are not among `used`: where their neighbours in exposure order are, if there are any.
void place_unusable(const Bracket& bracket, const std::vector<int>& used, std::vector<FrameAlignment>& frames);

}  // namespace hdr::internal
