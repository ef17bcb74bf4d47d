#pragma once
// From places to rows: what is decided about each shot, and how it is said.
#include <vector>

#include "libhdr/align/align.h"
#include "libhdr/align/internal/joint.h"

namespace hdr::internal {

/// Do the shots stay where they are? Yes where all lie within a tenth of a pixel of the reference; and where moving
/// them would bring them no nearer: the squares of the measured motions, summed over the shots, are less than those of
/// the errors that moving leaves, its resampling included. (Film scans that were registered by hand are such a
/// bracket.)
bool bracket_stays(const MotionFrame& frame, const std::vector<Place>& places);

/// The row of a shot that has a place. `bracket_still`: all of them keep the identity.
FrameAlignment decided(const MotionFrame& frame, const Place& place, bool bracket_still);

/// Rows of the shots that are not among `used`: where their neighbours in exposure order are, if there are any.
void place_unusable(const Bracket& bracket, const std::vector<int>& used, std::vector<FrameAlignment>& frames);

}  // namespace hdr::internal
