#pragma once
// The harmonics whose irradiance is closest to a probe's: not its projection, whose error is least on average.
#include "libhdr/light/sh.h"

namespace hdr {

struct FittedSh {
  Sh sh;
  double error = 0;      ///< largest |E - E_sh| over the normals that were looked at, of the largest E, worst channel
  double projected = 0;  ///< the same of the projection
};

/// Of a lat-long: the coefficients of `degree` for which the largest error of the irradiance over all normals is least
/// (a grid of them; each channel for itself), by reweighted least squares [Lawson61]. Bands that have no irradiance
/// (odd ones above 1) are the projection's.
FittedSh fit_irradiance(View<const float> latlong, int degree);

}  // namespace hdr
