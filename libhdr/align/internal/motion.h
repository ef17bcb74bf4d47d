#pragma once
// Motions of the picture plane, from a shift to a homography: p_b = M p_a, pixel centres at integers. Small motions are
// written as eight numbers in pixels, nested so that each model is the first few of them:
//   0 1 shift | 2 turn | 3 zoom, 4 5 stretch | 6 7 keystone
// Each number is the displacement it causes at the picture's corner (half a diagonal from the middle), or less.
#include <array>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

inline constexpr int kMotionUnknowns = 8;
using MotionVector = Eigen::Matrix<double, kMotionUnknowns, 1>;
using MotionMatrix = Eigen::Matrix<double, kMotionUnknowns, kMotionUnknowns>;
using MotionBasis = Eigen::Matrix<double, 2, kMotionUnknowns>;

/// Its value is the number of unknowns it uses.
enum class MotionModel { kTranslation = 2, kRigid = 3, kAffine = 6, kProjective = 8 };
inline constexpr std::array<MotionModel, 4> kMotionModels = {MotionModel::kTranslation, MotionModel::kRigid,
                                                             MotionModel::kAffine, MotionModel::kProjective};
inline int unknowns(MotionModel model) {
  return static_cast<int>(model);
}

/// The picture on which motions are written: its middle, and half its diagonal.
struct MotionFrame {
  explicit MotionFrame(Size picture_size);

  Size size;
  Vec2 middle;
  double radius;

  /// Displacement at p of each unit vector.
  MotionBasis basis(const Vec2& p) const;
  /// The motion whose displacement is basis(p) * small, to first order; exactly rigid when only the first three are
  /// set.
  Mat3 motion(const MotionVector& small) const;
  /// The inverse of motion(): exact for rigid motions, whatever their size, to first order in the rest.
  MotionVector vector(const Mat3& motion) const;
  /// Root mean square over the picture of a displacement with this covariance.
  double rms(const MotionMatrix& covariance) const;
  /// Root mean square and largest distance over the picture between where two motions take a pixel.
  double rms_between(const Mat3& one, const Mat3& other) const;
  double farthest_between(const Mat3& one, const Mat3& other) const;
};

inline Vec2 moved(const Mat3& motion, const Vec2& p) {
  return (motion * p.homogeneous()).hnormalized();
}

Mat3 shift_by(const Vec2& shift);

/// The same motion between pictures whose pixels average `cell` x `cell` pixels of the photographs.
Mat3 motion_of_cells(const Mat3& motion, int cell);

}  // namespace hdr::internal
