#pragma once
#include <cstdint>

#include "libhdr/response/response.h"

namespace hdr::bench {

/// An 8-bit film-like camera, another one for each seed: a Hill curve, an exponential shoulder behind a gamma, or an
/// arctangent in log exposure, its parameters and the small differences between its channels drawn at random.
Response random_film_response(std::uint64_t seed);

}  // namespace hdr::bench
