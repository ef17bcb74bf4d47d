#pragma once
// What every calibration asks of a bracket before it, and does for its channels after it.
#include <array>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/response/internal/observations.h"

namespace hdr {

/// Throws Error unless there are two shots or more, each with a positive exposure, and not all with the same.
void check_exposures(const Bracket& bracket);

/// Empties the channels that say too little of a curve, and returns a warning for each of them, and for codes that no
/// two shots share. Throws Error when no channel is left.
std::vector<std::string> check_coverage(Observations& seen, const Bracket& bracket);

/// Throws Error when most points are darker, or the same, in the longer of two shots: the times contradict the
/// pictures.
void check_brightening(const Observations& seen, const Bracket& bracket);

/// An empty curve becomes the mean of the others.
void borrow_curves(std::array<std::vector<double>, 3>& curves_of_channels);

}  // namespace hdr
