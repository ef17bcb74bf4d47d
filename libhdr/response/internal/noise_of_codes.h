#pragma once
// estimate_noise() from codes that someone else has read already.
#include <vector>

#include "libhdr/response/estimate_noise.h"
#include "libhdr/response/internal/sample_places.h"

namespace hdr::internal {

/// The places that estimate_noise() looks at.
CodesAtPlaces noise_places(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo);

/// The rest of it. `seen`: noise_places() of the bracket, with the shots looked at.
NoiseEstimate estimate_noise(const Bracket& bracket, const CodesAtPlaces& seen, const Response& response,
                             const std::vector<bool>& left_out, const std::vector<double>& exposures);

}  // namespace hdr::internal
