#include "libhdr/probe/internal/ball_glimpse.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/patch_picture.h"

namespace hdr {
namespace {

using internal::BallGlimpses;
using internal::Glimpse;

/// Balls of all kinds: before a far camera, on a near one's axis, beside it.
MirrorBall random_ball(Random& random, int kind) {
  MirrorBall ball{{200 + 600 * random.uniform(), 200 + 400 * random.uniform(), 80 + 150 * random.uniform()}};
  if (kind > 0) ball.distance = 3 * std::exp2(4 * random.uniform());
  if (kind > 1) ball.principal = Vec2(500, 375);
  return ball;
}

Vec3 random_direction(Random& random) {
  return Vec3(random.normal(), random.normal(), random.normal()).normalized();
}

double inverse_of(const MirrorBall& ball) {
  return std::isinf(ball.distance) ? 0 : 1 / ball.distance;
}

TEST(BallGlimpse, ShowsADirectionWhereTheProjectionDoes) {
  Random random(3, 1);
  int seen = 0, hidden = 0;
  for (int k = 0; k < 600; ++k) {
    const MirrorBall ball = random_ball(random, k % 3);
    const Vec3 dir = random_direction(random);
    const auto glimpse = BallGlimpses(ball, inverse_of(ball), Vec3::Zero())(dir);
    const auto px = ball.px_from_dir(dir);
    ASSERT_EQ(glimpse.has_value(), px.has_value()) << "case " << k;
    ++(px ? seen : hidden);
    if (!px) continue;
    EXPECT_LT((glimpse->px - *px).norm(), 1e-7 * ball.disc.r) << "case " << k;
  }
  EXPECT_GT(seen, 500);
  EXPECT_GT(hidden, 0) << "near balls hide a cone behind them";
}

// Against differences of the projection itself, over steps long beside its rounding and short beside its curvature.
TEST(BallGlimpse, ItsDerivativesAreThoseOfTheProjection) {
  constexpr double kStep = 1e-5;
  Random random(4, 1);
  for (int k = 0; k < 300; ++k) {
    const MirrorBall ball = random_ball(random, k % 3);
    const Vec3 dir = random_direction(random);
    const double inverse = inverse_of(ball);
    const auto px_at = [&](const Vec3& d, double more_inverse, const Vec3& outline) {
      return internal::changed(ball, inverse + more_inverse, outline).px_from_dir(d.normalized());
    };
    const Vec3 camera = -(ball.principal && k % 3 == 2 ? internal::camera_of(ball).to_ball : Vec3(0, 0, -1));
    if (dir.dot(camera) < -0.9) continue;  // towards the rim derivatives grow without bound
    const auto glimpse = BallGlimpses(ball, inverse, Vec3::Zero())(dir);
    ASSERT_TRUE(glimpse) << "case " << k;
    const Vec3 t = dir.unitOrthogonal();
    for (const Vec3& move : {t, Vec3(dir.cross(t))}) {
      const Vec2 slope =
          (*px_at(dir + kStep * move, 0, Vec3::Zero()) - *px_at(dir - kStep * move, 0, Vec3::Zero())) / (2 * kStep);
      EXPECT_LT((glimpse->px_from_dir * move - slope).norm(), 1e-4 * ball.disc.r) << "case " << k;
    }
    for (int part = 0; part < 3; ++part) {
      const Vec2 slope =
          (*px_at(dir, 0, kStep * Vec3::Unit(part)) - *px_at(dir, 0, -kStep * Vec3::Unit(part))) / (2 * kStep);
      EXPECT_LT((glimpse->px_from_outline.col(part) - slope).norm(), 1e-3 * ball.disc.r)
          << "case " << k << ", part " << part;
    }
    if (k % 3 == 0) continue;  // a far camera stays far
    const Vec2 nearing = (*px_at(dir, kStep, Vec3::Zero()) - *px_at(dir, -kStep, Vec3::Zero())) / (2 * kStep);
    EXPECT_LT((glimpse->px_from_inverse_distance - nearing).norm(), 1e-2 * ball.disc.r) << "case " << k;
  }
}

TEST(BallGlimpse, TowardsTheCameraAllWaysAreAlike) {
  const MirrorBall ball{{500, 375, 100}, 6};
  const auto glimpse = BallGlimpses(ball, 1.0 / 6, Vec3::Zero())(Vec3(0, 0, 1));
  ASSERT_TRUE(glimpse);
  EXPECT_NEAR((glimpse->px - Vec2(500, 375)).norm(), 0, 1e-9);
  EXPECT_NEAR(glimpse->px_from_dir.col(0).norm(), glimpse->px_from_dir.col(1).norm(), 1e-9);
  EXPECT_GT(glimpse->px_from_dir(0, 0), 40) << "right in the picture is right";
  EXPECT_LT(glimpse->px_from_dir(1, 1), -40) << "up is up";
  EXPECT_FALSE(BallGlimpses({{500, 375, 100}}, 0, Vec3::Zero())(Vec3(0, 0, -1)))
      << "the whole rim shows what is behind";
}

TEST(PatchPicture, OfARampTheMeanIsTheMiddleAndTheSlopeIsIts) {
  Image<float> ramp(40, 30, 1);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) ramp(x, y) = static_cast<float>(2 + 0.25 * (x + 0.5) - 0.5 * (y + 0.5));
  }
  const internal::PatchPicture picture(ramp);
  Eigen::Matrix2d sides;
  sides << 3, 1, -1, 4;
  const internal::PatchMean patch = picture.mean({20.3, 14.8}, sides);
  EXPECT_NEAR(patch.value, 2 + 0.25 * 20.3 - 0.5 * 14.8, 1e-5);
  EXPECT_NEAR(patch.slope.x(), 0.25, 1e-6);
  EXPECT_NEAR(patch.slope.y(), -0.5, 1e-6);
  EXPECT_TRUE(picture.holds({0.1, 29.9}));
  EXPECT_FALSE(picture.holds({-0.1, 15}));
}

}  // namespace
}  // namespace hdr
