#pragma once
// One view of a ball as a function on the sphere, at several scales.
#include <optional>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/ball_views.h"

namespace hdr::internal {

/// The ball seen from another distance (1 / radii, 0: far), its outline's centre moved and its radius grown, in radii.
MirrorBall changed(const MirrorBall& ball, double inverse_distance, const Vec3& outline);

/// How well a view shows a direction of its own axes, 0..1, apart from its photographer: the cosine of incidence at
/// which the ball shows it, 0 where it does not or where the picture ends.
double visibility(const BallView& view, const Vec3& dir);

/// How likely a direction of a view's axes shows no photographer, 0..1: 0 around the direction to the camera and from
/// there down to the feet.
double nobody_there(const BallView& view, const Vec3& dir);

/// Where a picture shows a direction, and how that place moves.
struct Glimpse {
  Vec2 px = Vec2::Zero();
  /// Derivatives: of moves across the direction, of 1 / distance, of the outline's radius in radii.
  Eigen::Matrix<double, 2, 3> px_from_dir = Eigen::Matrix<double, 2, 3>::Zero();
  Vec2 px_from_inverse_distance = Vec2::Zero(), px_from_growth = Vec2::Zero();
};

/// A picture's mean over a parallelogram, and how it changes when that moves.
struct PatchMean {
  double value = 0;
  Vec2 slope = Vec2::Zero();  ///< a pixel
};

/// Log luminance, made smaller until the ball's radius is near `radius_px`, with the ball's geometry in it.
struct LogView {
  Image<float> log_luminance;
  MirrorBall ball;

  /// nullopt where the ball does not show the direction. `outline`: how much the centre is moved and the radius grown,
  /// in radii.
  std::optional<double> at(const Vec3& dir, double inverse_distance, const Vec3& outline = Vec3::Zero()) const;
  std::optional<Glimpse> glimpse(const Vec3& dir, double inverse_distance, const Vec3& outline) const;
  /// Around px; the parallelogram's sides are the columns.
  PatchMean mean(const Vec2& px, const Eigen::Matrix2d& sides) const;
};
LogView log_view(const BallView& view, double radius_px);

/// Detail of log luminance as a function of directions in the view's axes, at a resolution of 360 / width degrees: less
/// what a wide blur leaves of it. Kept for fast reading on an octahedral map [Cigolle14], nearest cell.
class SphereMap {
 public:
  struct Cell {
    float value = 0, weight = 0;
  };
  SphereMap(const BallView& view, int width);
  const Cell& at(const Vec3& dir) const;

 private:
  int side_;
  std::vector<Cell> cells_;
};

/// `count` directions spread evenly [Swinbank06].
std::vector<Vec3> even_directions(int count);

}  // namespace hdr::internal
