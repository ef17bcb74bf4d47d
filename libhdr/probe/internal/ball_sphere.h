#pragma once
// One view of a ball as a function on the sphere, at several scales.
#include <optional>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/ball_views.h"

namespace hdr::internal {

/// How well a view shows a direction of its own axes, 0..1, apart from its photographer: the cosine of incidence at
/// which the ball shows it, 0 where it does not or where the picture ends.
double visibility(const BallView& view, const Vec3& dir);

/// How likely a direction of a view's axes shows no photographer, 0..1: 0 around the direction to the camera and from
/// there down to the feet.
double nobody_there(const BallView& view, const Vec3& dir);

/// Log luminance, made smaller until the ball's radius is near `radius_px`, with the ball's geometry in it.
struct LogView {
  Image<float> log_luminance;
  MirrorBall ball;

  /// nullopt where the ball does not show the direction. `outline`: how much the centre is moved and the radius grown,
  /// in radii.
  std::optional<double> at(const Vec3& dir, double inverse_distance, const Vec3& outline = Vec3::Zero()) const;
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
  /// From a picture of the view with a ball of radius_for(width), whose distance may be another.
  SphereMap(const BallView& view, const LogView& picture, int width);
  /// Pixels: one of the picture is one of the map, in the middle of the ball.
  static double radius_for(int width) { return width / 3.0; }
  const Cell& at(const Vec3& dir) const;

 private:
  int side_;
  std::vector<Cell> cells_;
};

/// What a map shows in given directions, of those in which it shows anything.
class SampledSphere {
 public:
  SampledSphere(const SphereMap& map, const std::vector<Vec3>& directions);
  /// Weighted correlation with another map's detail under a rotation, -1 where they hardly overlap.
  double correlation(const SphereMap& other, const Mat3& here_from_other) const;

 private:
  struct Sample {
    Vec3 dir;
    SphereMap::Cell cell;
  };
  std::vector<Sample> samples_;
  std::size_t directions_;
};

/// `count` directions spread evenly [Swinbank06].
std::vector<Vec3> even_directions(int count);

}  // namespace hdr::internal
