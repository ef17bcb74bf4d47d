#pragma once
// Registration: where each shot's pixels fall on the reference shot.
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/response.h"

namespace hdr {

enum class AlignMethod {
  kAuto,      ///< robust Gauss-Newton in log radiance; features where that fails; nothing where the shots lie still
  kNone,      ///< identity
  kMtb,       ///< median threshold bitmaps [Ward03], whole pixels
  kEcc,       ///< enhanced correlation coefficient [Evangelidis08], OpenCV's
  kFeatures,  ///< ORB features [Rublee11] and their largest consensus
};

/// "auto", "none", "mtb", "ecc", "features"; nullopt for any other text.
std::optional<AlignMethod> align_method_from_name(const std::string& name);

/// One row for each shot, in the order of Bracket::shots.
struct FrameAlignment {
  Mat3 ref_from_photo = Mat3::Identity();  ///< p_ref = ref_from_photo * p_photo, pixel centres at integers
  double residual_px = 0;  ///< estimated error of the registration, pixels: root mean square over the picture
  double inliers = 0;      ///< share of the textured tiles that agree with the motion
  std::string skipped;     ///< why this shot was not (or need not be) registered; else empty
};

struct Alignment {
  int reference = 0;  ///< index into Bracket::shots
  std::vector<FrameAlignment> frames;
  bool identity() const;  ///< no shot moves: nothing is resampled
  std::vector<Mat3> ref_from_photo() const;
};

/// Neighbours and next neighbours in exposure order, on linearised and exposure-matched pairs, reconciled jointly on
/// the reference (the best-exposed shot). A shift, a rigid motion, an affine one or a homography, as the pictures
/// support it. Shots that are registered already keep the identity, and `skipped` says so with the measured bound in
/// pixels. `response` may be provisional: a photometric match is estimated with each pair.
Alignment align(const Bracket& bracket, const Response& response, AlignMethod method = AlignMethod::kAuto);

/// Identity for every shot.
Alignment no_alignment(const Bracket& bracket);

}  // namespace hdr
