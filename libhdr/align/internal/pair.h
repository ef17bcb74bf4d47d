#pragma once
// The motion between two neighbours of a bracket, as each method reports it.
#include <optional>
#include <span>
#include <string>

#include "libhdr/align/internal/log_picture.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

using Mat2 = Eigen::Matrix2d;

/// p_b = p_a + b_from_a, in photograph pixels.
struct PairMotion {
  Vec2 b_from_a = Vec2::Zero();
  Mat2 covariance = Mat2::Zero();  ///< of b_from_a
  std::string trouble;             ///< why the motion could not be measured (b_from_a is then 0); else empty

  double error_px() const { return std::sqrt(covariance.trace()); }
};

inline PairMotion failed(const std::string& why) {
  PairMotion motion;
  motion.trouble = why;
  return motion;
}

/// search.cpp: the shifts (in photograph pixels) at which two small pictures correlate best, the best first, every
/// whole shift within `radius` of their pixels tried. Empty: too little in common.
std::vector<Vec2> search_shifts(const LogPicture& a, const LogPicture& b, int radius, std::size_t most);

/// refine.cpp: coarse to fine from the best of `starts`, on pyramids whose first level is the finest.
PairMotion refine_shift(std::span<const LogPicture> a, std::span<const LogPicture> b, std::span<const Vec2> starts);

/// refine.cpp: the error of a shift found by other means, and whether it explains the pictures better than none does.
PairMotion assess_shift(const LogPicture& a, const LogPicture& b, const Vec2& b_from_a);

/// ecc.cpp: coarse to fine from `start` with OpenCV's findTransformECC.
PairMotion ecc_shift(std::span<const LogPicture> a, std::span<const LogPicture> b, const Vec2& start);

/// mtb.cpp: on the codes themselves; no response is needed.
PairMotion mtb_shift(const Photo& a, const Photo& b);

/// features.cpp
PairMotion feature_shift(const LogPicture& a, const LogPicture& b);

}  // namespace hdr::internal
