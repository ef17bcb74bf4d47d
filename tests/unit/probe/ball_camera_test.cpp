// Balls beside the camera's axis, their reflectance, and whoever stands behind the camera.
#include "libhdr/probe/internal/ball_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/probe/find_ball.h"
#include "libhdr/probe/photograph.h"
#include "libhdr/probe/photographer.h"
#include "libhdr/probe/reflectance.h"
#include "libhdr/probe/unwrap.h"
#include "tests/support/rounds.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

/// A ball somewhere in a camera's picture, and the same by hand: its centre in space, the camera at the origin.
struct Placed {
  Size size{1500, 1000};
  double fov, focal;
  Vec3 centre;
  MirrorBall ball;
};

Placed random_ball(std::uint64_t seed) {
  Random random(seed, 3);
  Placed p;
  p.fov = 25 + 60 * random.uniform();
  p.focal = 0.5 * p.size.width / std::tan(0.5 * p.fov * kDegree);
  const double distance = 3 * std::exp2(4 * random.uniform());
  const double off = (0.5 * p.fov * kDegree) * 0.8 * random.uniform(), around = 2 * kPi * random.uniform();
  p.centre = distance * Vec3(std::sin(off) * std::cos(around), std::sin(off) * std::sin(around), -std::cos(off));
  // The outline by its two ends on the line through the principal point, and the closed form's smaller half-axis.
  const double a = std::asin(1 / distance);
  const double near = p.focal * std::tan(off - a), far = p.focal * std::tan(off + a);
  const double q = std::cos(a) * std::cos(a) - std::sin(off) * std::sin(off);
  const Vec2 out(std::cos(around), -std::sin(around));
  const Vec2 centre = Vec2(0.5 * p.size.width, 0.5 * p.size.height) + 0.5 * (near + far) * out;
  p.ball = ball_in_photograph({centre.x(), centre.y(), p.focal * std::sin(a) / std::sqrt(q)}, p.size, p.fov);
  return p;
}

/// The mirrored ray of a pixel from the ball's definition: the quadratic equation, nothing closed.
std::optional<Vec3> traced(const Placed& p, const Vec2& px) {
  const Vec3 v =
      Vec3((px.x() - 0.5 * p.size.width) / p.focal, -(px.y() - 0.5 * p.size.height) / p.focal, -1).normalized();
  const double b = v.dot(p.centre), discriminant = b * b - p.centre.squaredNorm() + 1;
  if (discriminant < 0) return std::nullopt;
  const Vec3 n = (b - std::sqrt(discriminant)) * v - p.centre;
  return v - 2 * v.dot(n) * n;
}

TEST(BallBesideTheAxis, ShowsWhatTheTrueRayMeets) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Placed p = random_ball(seed);
    EXPECT_NEAR(p.ball.distance / p.centre.norm(), 1, 1e-9) << "distance from outline and field, seed " << seed;
    const internal::Ellipse outline = internal::outline_of(p.ball);
    for (int k = 0; k < 60; ++k) {
      const double angle = 0.7 * k, r = 1.05 * std::sqrt((k + 0.5) / 60);
      const Vec2 aside(-outline.along.y(), outline.along.x());
      const Vec2 px = outline.centre +
                      r * (outline.major * std::cos(angle) * outline.along + outline.minor * std::sin(angle) * aside);
      const auto expected = traced(p, px), dir = p.ball.dir_from_px(px);
      ASSERT_EQ(dir.has_value(), r < 1) << "inside means inside the ellipse; seed " << seed << ", r " << r;
      ASSERT_EQ(expected.has_value(), r < 1);
      if (!dir) continue;
      ASSERT_LT((*dir - *expected).norm(), 1e-9) << "seed " << seed << " at " << px.transpose();
      const auto back = p.ball.px_from_dir(*dir);
      ASSERT_TRUE(back);
      ASSERT_LT((*back - px).norm(), 1e-5) << "seed " << seed << " at " << px.transpose();
      const Vec3 to_camera = -Vec3((px.x() - 750) / p.focal, -(px.y() - 500) / p.focal, -1).normalized();
      ASSERT_NEAR(*cos_incidence(p.ball, px), (*dir + to_camera).normalized().dot(to_camera), 1e-7);
    }
  }
}

TEST(BallBesideTheAxis, OnTheAxisItIsTheBallWithoutAPrincipalPoint) {
  const MirrorBall plain{{400, 300, 120}, 6};
  const MirrorBall on_axis{{400, 300, 120}, 6, Vec2(400, 300)};
  for (int k = 0; k < 50; ++k) {
    const Vec2 px(400 + 2.3 * k * std::cos(k), 300 + 2.3 * k * std::sin(k));
    ASSERT_LT((*plain.dir_from_px(px) - *on_axis.dir_from_px(px)).norm(), 1e-12);
    ASSERT_NEAR(*cos_incidence(plain, px), *cos_incidence(on_axis, px), 1e-9);
  }
}

TEST(BallBesideTheAxis, ItsElongationGivesTheDistance) {
  for (std::uint64_t seed = 41; seed <= 60; ++seed) {
    const Placed p = random_ball(seed);
    const internal::Ellipse outline = internal::outline_of(p.ball);
    if (outline.major / outline.minor < 1.001) continue;
    const auto ball = internal::ball_from_elongation(p.ball.disc, *p.ball.principal, outline.major / outline.minor);
    ASSERT_TRUE(ball) << "seed " << seed;
    EXPECT_NEAR(ball->distance / p.ball.distance, 1, 1e-6) << "seed " << seed;
  }
}

TEST(BallBesideTheAxis, ItsTextReadsBack) {
  const MirrorBall ball{{400.5, 300, 120}, 6.25, Vec2(750, 500)};
  const auto read = projection_from_text(text_from_projection(ball), {1500, 1000});
  ASSERT_TRUE(read);
  const auto& back = std::get<MirrorBall>(*read);
  ASSERT_TRUE(back.principal);
  EXPECT_EQ(*back.principal, *ball.principal);
  EXPECT_EQ(back.distance, ball.distance);
  EXPECT_FALSE(projection_from_text("mirror-ball px=3", {100, 100})) << "half a principal point";
}

/// The share of directions whose radiance is further than `tolerance` (log2) from the room's, far from blind spots.
double share_wrong(const Image<float>& probe, const test::SoftRoom& room, const Mat3& turn, double tolerance) {
  int wrong = 0, all = 0;
  for (int y = 0; y < probe.height(); ++y) {
    for (int x = 0; x < probe.width(); ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / probe.width(), (y + 0.5) / probe.height());
      if (d.z() < -std::cos(40 * kDegree)) continue;
      ++all;
      if (std::abs(std::log2(probe(x, y, 1) / room(turn * d, 1))) > tolerance) ++wrong;
    }
  }
  return static_cast<double>(wrong) / all;
}

TEST(BallBesideTheAxis, GivesTheSceneBack) {
  for (std::uint64_t seed = 71; seed < 71 + test::rounds(4); ++seed) {
    Placed p = random_ball(seed);
    const test::SoftRoom room(seed, 0.2);
    const Mat3 turn = rotation_from_degrees({8, 47.0 * double(seed), -3});
    const Image<float> picture = photograph_ball(test::latlong_of(512, room), p.size, p.ball, 35, turn);
    const Image<float> probe = resample(picture, p.ball, LatLong{{128, 64}}, {128, 64});
    const internal::Ellipse outline = internal::outline_of(p.ball);
    if (outline.minor < 60) continue;
    EXPECT_LT(share_wrong(probe, room, turn, 0.2), 0.02) << "seed " << seed << ", radius " << outline.minor;
  }
}

TEST(FindBallBesideTheAxis, TheOutlineIsAnEllipse) {
  for (std::uint64_t seed = 81; seed < 81 + test::rounds(4); ++seed) {
    Random random(seed, 4);
    const Size size{1000, 750};
    const double focal = 0.5 * 1000 / std::tan(30 * kDegree);
    const MirrorBall ball = internal::ball_from_focal(
        {300 + 100 * random.uniform(), 230 + 60 * random.uniform(), 130 + 60 * random.uniform()}, {500, 375}, focal);
    const Image<float> scene = test::latlong_of(512, test::SoftRoom(seed, 0.5));
    const Image<float> picture =
        photograph_ball(scene, size, ball, 35, rotation_from_degrees({0, 31.0 * double(seed), 0}));
    const internal::Ellipse truth = internal::outline_of(ball);
    for (const bool known : {true, false}) {
      const auto found = find_ball(picture, {known ? std::optional(60.0) : std::nullopt});
      ASSERT_TRUE(found) << "seed " << seed;
      const internal::Ellipse outline = internal::outline_of(found->ball);
      EXPECT_LT((outline.centre - truth.centre).norm(), 0.5) << "seed " << seed << " known " << known;
      EXPECT_NEAR(outline.minor, truth.minor, 0.5) << "seed " << seed << " known " << known;
      EXPECT_NEAR(outline.major, truth.major, 0.7) << "seed " << seed << " known " << known;
      EXPECT_NEAR(found->ball.distance / ball.distance, 1, known ? 0.01 : 0.3) << "seed " << seed;
    }
  }
}

TEST(Reflectance, DividedOutGivesTheSceneBack) {
  const test::SoftRoom room(91);
  const Image<float> scene = test::latlong_of(512, room);
  const MirrorBall ball{{250, 200, 180}, 8};
  const Rgb chrome(0.55, 0.56, 0.5);
  RadianceMap map;
  map.rgb = photograph_ball(scene, {500, 400}, ball, 35, Mat3::Identity(), chrome);
  EXPECT_NEAR(map.rgb(250, 200, 2) / room(Vec3(0, 0, 1), 2), 0.5, 0.01) << "head-on it is what was given";
  divide_by_reflectance(map, ball, chrome);
  for (int k = 0; k < 300; ++k) {
    const double r = 0.99 * std::sqrt((k + 0.5) / 300);
    const Vec2 px(std::floor(250 + 180 * r * std::cos(k)) + 0.5, std::floor(200 + 180 * r * std::sin(k)) + 0.5);
    const auto d = ball.dir_from_px(px);
    if (!d || (px - Vec2(250, 200)).norm() > 0.98 * 180) continue;
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(map.rgb(int(px.x()), int(px.y()), c) / room(*d, c), 1, 0.02) << "at " << r << " of the radius";
  }
  EXPECT_THROW(divide_by_reflectance(map, ball, {0.5, 0, 0.5}), Error);
  EXPECT_THROW(divide_by_reflectance(map, ball, {0.5, 1.1, 0.5}), Error);
}

TEST(Photographer, StandsInTheMiddleOfTheBall) {
  const test::SoftRoom room(95);
  const Image<float> scene = test::latlong_of(512, room);
  const Mat3 turn = rotation_from_degrees({0, 70, 0});
  const Image<float> with_figure = with_photographer(scene, 8, turn);
  const MirrorBall ball{{150, 120, 100}, 10};
  const Image<float> alone = photograph_ball(scene, {300, 240}, ball, 35, turn);
  const Image<float> figure = photograph_ball(with_figure, {300, 240}, ball, 35, turn);
  EXPECT_LT(figure(150, 122), 0.2f * alone(150, 122)) << "the trunk";
  EXPECT_LT(figure(150, 112), 0.2f * alone(150, 112)) << "the head, above";
  EXPECT_EQ(figure(190, 120), alone(190, 120)) << "beside him";
  EXPECT_EQ(figure(150, 60), alone(150, 60)) << "over his head";
  EXPECT_THROW(with_photographer(scene, 0), Error);
}

}  // namespace
}  // namespace hdr
