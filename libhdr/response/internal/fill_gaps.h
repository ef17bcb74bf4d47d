#pragma once
#include <vector>

namespace hdr {

/// Exposures at evenly spaced codes from 0 on, of which those that are not known are 0: linear between known
/// neighbours, proportional to the code below the lowest of them, and above the highest rising on, in logs, as they did
/// over the last sixteenth of all codes. At least one must be known. The first stays 0 unless it is known.
std::vector<double> fill_gaps(std::vector<double> exposures);

}  // namespace hdr
