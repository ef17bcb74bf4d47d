#pragma once
// Three colours from a Bayer mosaic, by LibRaw.
#include "libhdr/core/mosaic.h"
#include "libhdr/core/photo.h"

namespace hdr {

/// 16-bit codes, linear in the light: 0 is the black level (less than it counts as black), 65535 the white level.
/// Colours are the sensor's own: no white balance, no matrix.
///
/// A colour that a pixel did not see is interpolated (DHT: 3 to 5 dB closer to known pictures than OpenCV's
/// demosaicing, and never behind LibRaw's other methods). Where a neighbour of that colour is saturated it could only
/// be too low (by 0.15 to 0.2 log2 on average), and is given the saturated code instead: a merge then asks the shorter
/// exposures. Throws Error when white is not above black or the picture is smaller than 16x16.
Photo demosaic(const Mosaic& mosaic);

}  // namespace hdr
