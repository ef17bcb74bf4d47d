// Projections at any direction and any pixel, resampling of hostile maps, balls that are none, photographs of any
// world.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/find_ball.h"
#include "libhdr/probe/find_image_circle.h"
#include "libhdr/probe/photograph.h"
#include "libhdr/probe/projection.h"
#include "libhdr/probe/unwrap.h"
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

// Fewer pixels around than a kernel with lobes is wide.
TEST(ProbeStress, ALatLongOfTwoPixelsDoesNotRing) {
  for (const float darker : {0.02f, 0.1f, 0.5f}) {
    Image<float> map(2, 1, 3);
    for (int c = 0; c < 3; ++c) {
      map(0, 0, c) = 1;
      map(1, 0, c) = darker;
    }
    for (const int height : {1, 3, 24}) {
      const Size size{2 * height, height};
      EXPECT_LE(largest_of(resample(map, LatLong{map.size()}, LatLong{size}, size)), 1 + 1e-6) << darker;
    }
  }
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

Size size_of(const Projection& projection, int size) {
  if (const auto* cube = std::get_if<Cube>(&projection)) return cube->size();
  const bool wide = std::holds_alternative<LatLong>(projection) || std::holds_alternative<DualParaboloid>(projection);
  return {wide ? 2 * size : size, size};
}

// Pixels that are no pixels are not shown; nothing that is shown has a direction without length.
RC_GTEST_PROP(ProbeStress, PixelsAreShownOrNot, ()) {
  const int size = *rc::gen::element(1, 16, 333);
  const Projection projection = projection_of(*rc::gen::inRange(0, kProjections), size);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  const auto coordinate =
      rc::gen::oneOf(rc::gen::element(kNaN, kInfinity, -kInfinity, 1e100, -1e100, 0.0, -0.0),
                     rc::gen::map(rc::gen::inRange(-10, 1010), [=](int k) { return 1e-3 * k * size; }));
  const Vec2 px(*coordinate, *coordinate);
  const std::optional<Vec3> d = dir_from_px(projection, px);
  if (d) RC_ASSERT(d->allFinite() && std::abs(d->norm() - 1) < 1e-9);
}

// One value stays that value, and nothing is above what it was made from by more than a sinc can ring: the sizes of its
// eight weights add up to 1.8, each way.
RC_GTEST_PROP(ProbeStress, ResamplingIsAMeanOfWhatIsThere, ()) {
  const MapPlan plan = *any_latlong(32);
  const Image<float> map = made(plan);
  const int size = *rc::gen::element(1, 2, 9, 24);
  const Projection to = projection_of(*rc::gen::inRange(0, kProjections), size);
  const Image<float> out = resample(map, LatLong{map.size()}, to, size_of(to, size));
  RC_ASSERT(fault_of(out) == "");
  RC_ASSERT(largest_of(out) <= 1.8 * 1.8 * largest_of(map) + 1.2e-38);  // products of denormals have no digits
  if (plan.light == Light::kConstant) {
    for (int y = 0; y < out.height(); ++y) {
      for (int x = 0; x < out.width(); ++x) {
        RC_ASSERT(out(x, y) == 0 || std::abs(out(x, y) / map(0, 0) - 1) < 1e-5f);
      }
    }
  }
}

}  // namespace
}  // namespace hdr::stress
