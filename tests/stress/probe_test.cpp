// Projections at any direction, balls that are none, photographs of any world.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/find_ball.h"
#include "libhdr/probe/find_image_circle.h"
#include "libhdr/probe/photograph.h"
#include "libhdr/probe/projection.h"
#include "tests/stress/hostile.h"

namespace hdr::stress {
namespace {

Projection projection_of(int kind, int size) {
  const Disc disc{0.5 * size, 0.5 * size, 0.5 * size};
  switch (kind) {
    case 0:
      return LatLong{{2 * size, size}};
    case 1:
      return AngularMap{disc};
    case 2:
      return MirrorBall{disc};
    case 3:
      return MirrorBall{disc, 1.001};
    case 4:
      return MirrorBall{disc, 12, Vec2(0.2 * size, 0.9 * size)};
    case 5:
      return Rectilinear{{size, size}, 179};
    case 6:
      return Rectilinear{{size, size}, 60, {-0.2, 0.05, 1e-3, -1e-3, 0}};
    case 7:
      return Fisheye{disc, 360};
    case 8:
      return Fisheye{disc, 180, Lens::kOrthographic};
    case 9:
      return Fisheye{disc, 200, Lens::kStereographic};
    case 10:
      return Cube{Cube::Layout::kVerticalStrip, size};
    case 11:
      return Cube{Cube::Layout::kHorizontalCross, size};
    case 12:
      return Octahedral{{size, size}};
    case 13:
      return Octahedral{{size, size}, true};
    case 14:
      return Hemisphere{disc};
    default:
      return DualParaboloid{{2 * size, size}};
  }
}
constexpr int kProjections = 16;

// What a picture shows, it shows where the direction says: there and back, near poles, rims and corners too.
RC_GTEST_PROP(ProbeStress, DirectionsComeBack, ()) {
  const int kind = *rc::gen::inRange(0, kProjections), size = *rc::gen::element(1, 2, 16, 333, 4096);
  const Projection projection = projection_of(kind, size);
  const Vec3 d = *direction();
  const std::optional<Vec2> px = px_from_dir(projection, d);
  if (!px) return;
  RC_ASSERT(px->allFinite());
  const std::optional<Vec3> back = dir_from_px(projection, *px);
  if (!back) return;  // rounded over the rim
  RC_ASSERT(std::abs(back->norm() - 1) < 1e-9);
  // A ball's rim, a lens's edge and a camera of 179 degrees crowd directions into the last digits of a pixel.
  RC_ASSERT((*back - d).norm() < 2e-5);
}

// Pictures without a ball, without a circle, without anything.
RC_GTEST_PROP(ProbeStress, SearchesEndWithoutABall, ()) {
  const MapPlan plan = *any_map(64);
  Image<float> map = made(plan);
  if (*rc::gen::element(false, true)) spoil(map, plan.seed);
  const auto ball = find_ball(map);
  if (ball) RC_ASSERT(std::isfinite(ball->ball.disc.r) && ball->ball.disc.r > 0);
  find_image_circle(map);
}

RC_GTEST_PROP(ProbeStress, PhotographsOfAnyWorldAreLight, ()) {
  const MapPlan plan = *any_latlong(32);
  const Image<float> map = made(plan);
  const double distance = *rc::gen::element(1.01, 2.0, 100.0, std::numeric_limits<double>::infinity());
  const Image<float> ball =
      photograph_ball(map, {17, 13}, MirrorBall{{8.5, 6.5, *rc::gen::element(0.5, 5.0)}, distance});
  RC_ASSERT(fault_of(ball) == "");
  RC_ASSERT(fault_of(photograph_view(map, {17, 13}, *rc::gen::element(0.01, 60.0, 179.0))) == "");
}

}  // namespace
}  // namespace hdr::stress
