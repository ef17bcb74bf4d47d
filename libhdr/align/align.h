#pragma once
// Registration: where each shot's pixels fall on the reference shot.
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/response.h"

namespace hdr {

enum class AlignMethod { kAuto, kNone, kMtb, kEcc, kFeatures };

/// One row for each shot, in the order of Bracket::shots.
struct FrameAlignment {
  Mat3 ref_from_photo = Mat3::Identity();  ///< p_ref = ref_from_photo * p_photo, pixel centres at integers
  double residual_px = 0;                  ///< estimated error of the registration, pixels
  std::string skipped;                     ///< why this shot was not (or need not be) registered; else empty
};

struct Alignment {
  int reference = 0;  ///< index into Bracket::shots
  std::vector<FrameAlignment> frames;
  bool identity() const;  ///< no shot moves: nothing is resampled
  std::vector<Mat3> ref_from_photo() const;
};

/// Neighbour to neighbour in exposure order, on linearised and exposure-matched pairs, chained to the reference (the
/// best-exposed shot). Translations. Shots that are registered already keep the identity, and `skipped` says so with
/// the measured bound in pixels.
Alignment align(const Bracket& bracket, const Response& response, AlignMethod method = AlignMethod::kAuto);

/// Identity for every shot.
Alignment no_alignment(const Bracket& bracket);

}  // namespace hdr
