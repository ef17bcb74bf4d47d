#pragma once
// A camera's bytes -> a photograph.
#include <optional>

#include "capture/frame.h"
#include "libhdr/core/mosaic.h"
#include "libhdr/core/photo.h"

namespace hdr {

/// Whether codes are known to be linear in the light: of raw sensors they are; what a camera made of its own numbers
/// (YUYV, JPEG, RGB, grey) has a response that must be calibrated.
bool is_linear(const FrameFormat& format);

struct DevelopOptions {
  std::optional<double> f_number;  ///< of the lens
  std::optional<double> iso;       ///< at gain 1; ISO = iso * gain
};

/// What the frame was exposed with: as it was verified, else as it was asked.
Exposure exposure_of(const Frame& frame, const DevelopOptions& options = {});

/// RGB codes with exposure_of() the frame:
///   kGrey8, kRgb8, kYuyv, kMjpeg   8 bits as the camera means them. YUYV [BT601]: chroma is interpolated where it was
///                                  left out, and lossy, as JPEG's is
///   kGrey10 .. kGrey16, kRgb16     16 bits, black level at 0 and white level at 65535
///   Bayer                          16 bits, linear, demosaiced (libhdr/io/demosaic.h)
/// A frame with fewer bytes than its format needs, or a damaged JPEG, throws Error.
Photo develop(const Frame& frame, const DevelopOptions& options = {});

/// The codes of a Bayer frame, unpacked, as a DNG file keeps them.
Mosaic mosaic_from(const Frame& frame, const DevelopOptions& options = {});

}  // namespace hdr
