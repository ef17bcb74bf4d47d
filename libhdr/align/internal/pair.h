#pragma once
// The motion between two shots of a bracket, as each method reports it.
#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "libhdr/align/internal/evidence.h"
#include "libhdr/align/internal/log_picture.h"
#include "libhdr/align/internal/motion.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

using Mat2 = Eigen::Matrix2d;

/// p_b = b_from_a p_a, in photograph pixels. A measurement under one motion model: b_from_a motion(step), with the
/// covariance of step.
struct Measurement {
  MotionVector step = MotionVector::Zero();
  MotionMatrix covariance = MotionMatrix::Zero();
};

/// Share of the agreeing tiles from which a match is not doubted.
inline constexpr double kClean = 0.95;

struct PairMotion {
  Mat3 b_from_a = Mat3::Identity();
  MotionModel model = MotionModel::kTranslation;    ///< of b_from_a
  MotionModel richest = MotionModel::kTranslation;  ///< the last model with a measurement
  std::array<Measurement, kMotionModels.size()> measured{};
  double price = 0;            ///< of one unknown, in chi^2 (Evidence::price)
  Vec2 middle = Vec2::Zero();  ///< of what was compared, pixels of a
  Mat2 spread = Mat2::Zero();  ///< a root of the covariance of its places
  double inliers = 0;          ///< share of the textured tiles that agree with the motion
  double doubt_px = 0;         ///< of a failed pair
  std::string trouble;         ///< why the motion could not be measured (b_from_a is then the identity); else empty

  /// Of b_from_a, under its model.
  const MotionMatrix& covariance() const {
    const auto at = std::find(kMotionModels.begin(), kMotionModels.end(), model);
    return measured[static_cast<std::size_t>(at - kMotionModels.begin())].covariance;
  }
};

/// `doubt_px`: how far the truth may be from no motion; 0: as far as such a camera moves.
inline PairMotion failed(const std::string& why, double inliers = 0, double doubt_px = 0) {
  PairMotion motion;
  motion.trouble = why;
  motion.inliers = inliers;
  motion.doubt_px = doubt_px;
  return motion;
}

/// How far motions are looked for, at least: the doubt about shots that show something, but nothing in common.
inline double searched_px(Size size) {
  return 0.1 * MotionFrame(size).radius;
}

/// A shift with its covariance, of pictures of this size, as methods report it that know no other motion.
PairMotion shift_motion(Size size, const Vec2& shift, const Mat2& covariance);

/// One shot at every scale that Gauss-Newton visits, the finest first, and the photograph's size.
struct Pyramid {
  Size size;
  std::vector<LogPicture> levels;
  std::size_t coarse() const { return levels.size() > 1 ? 1 : 0; }  ///< where rivals are told apart, for less work
};

/// search.cpp: the shifts (in photograph pixels) at which two small pictures correlate best, the best first, every
/// whole shift within `radius` of their pixels tried. Empty: too little in common.
std::vector<Vec2> search_shifts(const LogPicture& a, const LogPicture& b, int radius, std::size_t most);

/// search.cpp: the same for turns of some degrees about the middle of a photograph of this size, with a shift each: a
/// few usable pixels hide a turn from a refinement that starts without one, or let it pass for a shift.
std::vector<Mat3> search_turns(const LogPicture& a, const LogPicture& b, Size photo, int radius, std::size_t most);

/// search.cpp: shifts (photograph pixels) by which the picture around `middle` looks like itself, at any scale: a
/// pattern that repeats. Of two opposite ones one.
std::vector<Vec2> repeats(const Pyramid& picture, const Vec2& middle);

/// refine.cpp: coarse to fine from the best of `starts`; the model grows as the pictures support it.
PairMotion refine_motion(const Pyramid& a, const Pyramid& b, std::span<const Mat3> starts);

/// refine.cpp: at the finest level only, from a motion that is nearly right.
PairMotion polish_motion(const Pyramid& a, const Pyramid& b, const Mat3& start, MotionModel model);

/// Of the textured tiles: fewer show another scene, or another motion.
inline constexpr double kLeastInliers = 0.5;

/// refine.cpp: from no motion at all, linearised once the photometric match is known; `inliers` is the share of the
/// tiles that agree that nothing moved, `place` tells the tiles where in the photograph they lie.
PairMotion refine_in_place(Size size, const LogPicture& a, const LogPicture& b, double inliers,
                           const std::function<void(Linearization&)>& place);

/// refine.cpp: the error of a shift found by other means, and whether it explains the pictures better than none does.
PairMotion assess_shift(const Pyramid& a, const Pyramid& b, const Vec2& b_from_a);

/// agreement.cpp: of the tiles in which both pictures show texture above their noise, the share whose gradients
/// correlate under the motion; where they are few, the correlation of all that is in common. nullopt: no texture there.
std::optional<double> agreement(const LogPicture& a, const LogPicture& b, const Mat3& b_from_a);

/// ecc.cpp: coarse to fine from `start` with OpenCV's findTransformECC.
PairMotion ecc_shift(const Pyramid& a, const Pyramid& b, const Vec2& start);

/// mtb.cpp: on the codes themselves; no response is needed.
PairMotion mtb_shift(const Photo& a, const Photo& b);

/// features.cpp: a rigid motion, whatever its size.
PairMotion feature_motion(const Pyramid& a, const Pyramid& b);

}  // namespace hdr::internal
