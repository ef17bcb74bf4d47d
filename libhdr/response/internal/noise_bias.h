#pragma once
// Noise moves the mean of dark codes.
#include "libhdr/response/internal/observations.h"
#include "libhdr/response/noise.h"
#include "libhdr/response/response.h"

namespace hdr {

/// The curve is bent where it is dark, and codes end at 0: the mean code of noisy light is not the code of the mean
/// light. Gives each observed mean the code that the camera would have given without noise, by the expectation that
/// `response` and `noise` predict (a gamma of 2.2 at ten electrons with a read noise of twelve: three codes of twelve).
/// Channels with a black level are left alone: below their pedestal noise is not cut off.
Observations without_noise_bias(const Observations& observed, const Response& response, const Noise& noise);

}  // namespace hdr
